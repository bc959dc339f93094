/* Threads that wait for work: started once, used for every frame. The door to pthread. */
#ifndef ZT_BASE_POOL_H
#define ZT_BASE_POOL_H

#include <zoetrope/status.h>

typedef struct zt_pool zt_pool;

/* The number of cores this process may run on; at least 1. */
int zt_pool_core_count(void);

/* A pool of `thread_count` (at least 1) threads, the caller's own counted: n - 1 are started.
 */
zt_status zt_pool_open(zt_pool **pool, int thread_count);
void zt_pool_close(zt_pool **pool);
int zt_pool_thread_count(const zt_pool *pool);

/* Calls task(user, i, worker) once for each i in 0 .. task_count - 1, on all threads; returns
 * when all calls have returned. `worker` is 0 .. thread_count - 1, and no two calls with the
 * same one overlap. Which worker gets which task is open. Not to be called from within a task.
 */
void zt_pool_run(zt_pool *pool, int task_count, void (*task)(void *user, int task, int worker),
                 void *user);

/* One thing done behind the caller's back, on a thread of its own. */
typedef struct zt_errand zt_errand;

/* A thread that calls work(user) each time it is sent. One errand at a time. */
zt_status zt_errand_open(zt_errand **errand, void (*work)(void *user), void *user);
void zt_errand_send(zt_errand *errand); /* waits until the one before is done */
void zt_errand_wait(zt_errand *errand); /* returns when nothing is under way */
void zt_errand_close(zt_errand **errand);

#endif
