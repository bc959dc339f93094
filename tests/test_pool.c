/* Shows that the pool calls each task once, at the same time as others, and that errands run
 * behind the caller's back. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <threads.h>
#include <time.h>

#include <cmocka.h>

#include "base/pool.h"

enum { TASKS_MAX = 1000, THREADS_MAX = 8 };

typedef struct tally {
    atomic_int calls[TASKS_MAX];
    atomic_int at_work[THREADS_MAX]; /* calls under way with this worker number */
    atomic_int mistakes, unmasked;
    int thread_count;
} tally;

static void count_call(void *user, int task, int worker) {
    tally *t = user;
    sigset_t mask;
    if (worker < 0 || worker >= t->thread_count || task < 0 || task >= TASKS_MAX) {
        t->mistakes++;
        return;
    }
    if (atomic_fetch_add(&t->at_work[worker], 1) != 0) t->mistakes++;
    t->calls[task]++;
    pthread_sigmask(SIG_BLOCK, NULL, &mask);
    if (worker > 0 && !sigismember(&mask, SIGINT)) t->unmasked++;
    atomic_fetch_sub(&t->at_work[worker], 1);
}

/* Each task is called once, over many rounds, some of which find the threads asleep, no worker
 * number twice at a time; and the pool's threads leave signals to the program. */
static void pool_tasks(void **state) {
    (void)state;
    const int thread_counts[] = {1, 2, 3, THREADS_MAX}, task_counts[] = {0, 1, 7, TASKS_MAX};
    for (int i = 0; i < 4; i++) {
        zt_pool *pool;
        assert_int_equal(zt_pool_open(&pool, thread_counts[i]), ZT_OK);
        assert_int_equal(zt_pool_thread_count(pool), thread_counts[i]);
        tally t = {.thread_count = thread_counts[i]};
        int expected[TASKS_MAX] = {0};
        for (int round = 0; round < 200; round++) {
            if (round % 20 == 0) nanosleep(&(struct timespec){.tv_nsec = 200 * 1000}, NULL);
            int count = task_counts[round % 4];
            zt_pool_run(pool, count, count_call, &t);
            for (int k = 0; k < count; k++) expected[k]++;
        }
        for (int k = 0; k < TASKS_MAX; k++) assert_int_equal(t.calls[k], expected[k]);
        assert_int_equal(t.mistakes, 0);
        assert_int_equal(t.unmasked, 0);
        zt_pool_close(&pool);
        assert_null(pool);
        zt_pool_close(&pool);
    }
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, 0), ZT_EARGUMENT);
    assert_null(pool);
    assert_true(zt_pool_core_count() >= 1);
}

static void wait_for_all(void *user, int task, int worker) {
    (void)task, (void)worker;
    atomic_int *arrived = user;
    atomic_fetch_add(arrived, 1);
    while (atomic_load(arrived) < 3) thrd_yield();
}

/* Three tasks that wait for one another end only where three threads take them. */
static void pool_is_parallel(void **state) {
    (void)state;
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, 3), ZT_OK);
    atomic_int arrived = 0;
    zt_pool_run(pool, 3, wait_for_all, &arrived);
    assert_int_equal(arrived, 3);
    zt_pool_close(&pool);
}

typedef struct diary {
    atomic_int permits, ended;
} diary;

static void slow_work(void *user) {
    diary *d = user;
    while (d->permits <= d->ended) thrd_yield();
    nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
    d->ended++;
}

/* An errand runs behind the caller's back, one at a time; waiting and closing see it done. */
static void errands(void **state) {
    (void)state;
    diary d = {0};
    zt_errand *errand;
    assert_int_equal(zt_errand_open(&errand, slow_work, &d), ZT_OK);
    zt_errand_wait(errand); /* nothing is under way: returns at once */
    zt_errand_send(errand); /* does not wait for the work, which may not go on yet */
    assert_int_equal(d.ended, 0);
    d.permits = 3;
    zt_errand_send(errand);
    assert_true(d.ended >= 1); /* but for that of the one before */
    zt_errand_wait(errand);
    assert_int_equal(d.ended, 2);
    zt_errand_send(errand);
    zt_errand_close(&errand);
    assert_int_equal(d.ended, 3);
    assert_null(errand);
    zt_errand_close(&errand);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pool_tasks),
        cmocka_unit_test(pool_is_parallel),
        cmocka_unit_test(errands),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
