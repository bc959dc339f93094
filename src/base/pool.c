/* Two ways to use threads: a pool that shares out numbered tasks by an atomic counter, and an
 * errand boy that does one thing behind the caller's back. Locks are taken when work begins and
 * ends, never between tasks.
 *
 * A thread that sleeps takes some 20 microseconds to wake, as long as a small frame's tiles
 * take. So a run does not wait for workers that have not come by the time all tasks are taken,
 * and who waits for another thread looks for it a little, giving way to all others, before it
 * sleeps. */
#include "base/pool.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/clock.h"

struct zt_pool {
    pthread_mutex_t mutex;
    pthread_cond_t work_came, work_done;
    pthread_t *threads; /* thread_count - 1 of them; worker i + 1 is threads[i] */
    int thread_count;
    /* Changed under the lock, looked at without. */
    atomic_uint round;     /* counts the runs, so that a worker knows a new one from the last */
    atomic_int busy_count; /* workers that take part in this round and have not left it */
    atomic_bool closing;
    bool open; /* this round can be joined: there may be tasks left */
    void (*task)(void *user, int task, int worker);
    void *user;
    int task_count;
    atomic_int next_task;
};

typedef struct worker {
    zt_pool *pool;
    int index;
} worker;

/* Threads of ours leave signals to the program's own. */
static int start_thread(pthread_t *thread, void *(*body)(void *), void *argument) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(thread, NULL, body, argument);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return failed;
}

int zt_pool_core_count(void) {
    cpu_set_t cores;
    /* Fails where the kernel knows more cores than the set has room for. */
    bool known = sched_getaffinity(0, sizeof cores, &cores) == 0;
    int count = known ? CPU_COUNT(&cores) : (int)sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? count : 1;
}

static void take_tasks(zt_pool *pool, int index) {
    int task;
    while ((task = atomic_fetch_add_explicit(&pool->next_task, 1, memory_order_relaxed)) <
           pool->task_count)
        pool->task(pool->user, task, index);
}

static const double look_s = 50e-6;

static bool has_come(zt_pool *pool, unsigned seen_round) {
    return pool->round != seen_round || pool->closing;
}

/* Returns, with the lock, when there is a round that was not seen, or the pool closes. */
static void wait_for_round(zt_pool *pool, unsigned seen_round) {
    pthread_mutex_unlock(&pool->mutex);
    double end_s = zt_clock_s() + look_s;
    while (!has_come(pool, seen_round) && zt_clock_s() < end_s) sched_yield();
    pthread_mutex_lock(&pool->mutex);
    while (!has_come(pool, seen_round)) pthread_cond_wait(&pool->work_came, &pool->mutex);
}

/* The same when all workers have left the round. */
static void wait_for_workers(zt_pool *pool) {
    pthread_mutex_unlock(&pool->mutex);
    double end_s = zt_clock_s() + look_s;
    while (pool->busy_count > 0 && zt_clock_s() < end_s) sched_yield();
    pthread_mutex_lock(&pool->mutex);
    while (pool->busy_count > 0) pthread_cond_wait(&pool->work_done, &pool->mutex);
}

static void *worker_main(void *argument) {
    worker self = *(worker *)argument;
    free(argument);
    zt_pool *pool = self.pool;
    unsigned seen_round = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        wait_for_round(pool, seen_round);
        if (pool->closing) break;
        seen_round = pool->round;
        if (!pool->open) continue;
        pool->busy_count++;
        pthread_mutex_unlock(&pool->mutex);
        take_tasks(pool, self.index);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->busy_count == 0) pthread_cond_signal(&pool->work_done);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

zt_status zt_pool_open(zt_pool **out, int thread_count) {
    *out = NULL;
    if (thread_count < 1) return ZT_EARGUMENT;
    zt_pool *pool = calloc(1, sizeof *pool);
    if (!pool) return ZT_EMEMORY;
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->work_came, NULL);
    pthread_cond_init(&pool->work_done, NULL);
    pool->thread_count = 1;
    pool->threads = calloc((size_t)thread_count, sizeof *pool->threads);
    bool started = pool->threads != NULL;
    while (started && pool->thread_count < thread_count) {
        worker *self = malloc(sizeof *self);
        started = self != NULL;
        if (!started) break;
        *self = (worker){pool, pool->thread_count};
        started = start_thread(&pool->threads[pool->thread_count - 1], worker_main, self) == 0;
        if (started)
            pool->thread_count++;
        else
            free(self);
    }
    if (!started) {
        zt_pool_close(&pool);
        return ZT_EMEMORY;
    }
    *out = pool;
    return ZT_OK;
}

void zt_pool_close(zt_pool **slot) {
    zt_pool *pool = *slot;
    if (!pool) return;
    pthread_mutex_lock(&pool->mutex);
    pool->closing = true;
    pthread_cond_broadcast(&pool->work_came);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 0; i < pool->thread_count - 1; i++) pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->work_done);
    pthread_cond_destroy(&pool->work_came);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->threads);
    free(pool);
    *slot = NULL;
}

int zt_pool_thread_count(const zt_pool *pool) { return pool->thread_count; }

void zt_pool_run(zt_pool *pool, int task_count, void (*task)(void *user, int task, int worker),
                 void *user) {
    pthread_mutex_lock(&pool->mutex);
    pool->task = task;
    pool->user = user;
    pool->task_count = task_count;
    atomic_store_explicit(&pool->next_task, 0, memory_order_relaxed);
    pool->round++;
    pool->open = true;
    pthread_cond_broadcast(&pool->work_came);
    pthread_mutex_unlock(&pool->mutex);
    take_tasks(pool, 0);
    pthread_mutex_lock(&pool->mutex);
    pool->open = false;
    if (pool->busy_count > 0) wait_for_workers(pool);
    pthread_mutex_unlock(&pool->mutex);
}

struct zt_errand {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    pthread_t thread;
    bool under_way, closing;
    void (*work)(void *user);
    void *user;
};

static void *errand_main(void *argument) {
    zt_errand *errand = argument;
    pthread_mutex_lock(&errand->mutex);
    for (;;) {
        while (!errand->under_way && !errand->closing)
            pthread_cond_wait(&errand->changed, &errand->mutex);
        if (!errand->under_way) break;
        pthread_mutex_unlock(&errand->mutex);
        errand->work(errand->user);
        pthread_mutex_lock(&errand->mutex);
        errand->under_way = false;
        pthread_cond_broadcast(&errand->changed);
    }
    pthread_mutex_unlock(&errand->mutex);
    return NULL;
}

static void errand_free(zt_errand *errand) {
    pthread_cond_destroy(&errand->changed);
    pthread_mutex_destroy(&errand->mutex);
    free(errand);
}

zt_status zt_errand_open(zt_errand **out, void (*work)(void *user), void *user) {
    *out = NULL;
    zt_errand *errand = calloc(1, sizeof *errand);
    if (!errand) return ZT_EMEMORY;
    errand->work = work;
    errand->user = user;
    pthread_mutex_init(&errand->mutex, NULL);
    pthread_cond_init(&errand->changed, NULL);
    if (start_thread(&errand->thread, errand_main, errand) != 0) {
        errand_free(errand);
        return ZT_EMEMORY;
    }
    *out = errand;
    return ZT_OK;
}

void zt_errand_send(zt_errand *errand) {
    pthread_mutex_lock(&errand->mutex);
    while (errand->under_way) pthread_cond_wait(&errand->changed, &errand->mutex);
    errand->under_way = true;
    pthread_cond_broadcast(&errand->changed);
    pthread_mutex_unlock(&errand->mutex);
}

void zt_errand_wait(zt_errand *errand) {
    pthread_mutex_lock(&errand->mutex);
    while (errand->under_way) pthread_cond_wait(&errand->changed, &errand->mutex);
    pthread_mutex_unlock(&errand->mutex);
}

void zt_errand_close(zt_errand **slot) {
    zt_errand *errand = *slot;
    if (!errand) return;
    pthread_mutex_lock(&errand->mutex);
    errand->closing = true;
    pthread_cond_broadcast(&errand->changed);
    pthread_mutex_unlock(&errand->mutex);
    pthread_join(errand->thread, NULL);
    errand_free(errand);
    *slot = NULL;
}
