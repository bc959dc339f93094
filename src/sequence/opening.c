#include "sequence/opening.h"

#include "base/pool.h"
#include "encode/output.h"

bool zt_opening_takes(const zt_opening *o) { return zt_output_module(o->target) != NULL; }

static bool stopped(void *user) {
    zt_opening *o = user;
    const zt_watcher *w = o->watcher;
    return atomic_load(&o->refused) || (w && w->stopped && w->stopped(w->user));
}

zt_watcher zt_opening_watcher(zt_opening *o) {
    return (zt_watcher){.stopped = stopped, .user = o};
}

static void work(void *user) {
    zt_opening *o = user;
    o->worked = o->work(o->user);
}

zt_status zt_opening_open(zt_output **output, zt_opening *o) {
    zt_errand *errand = NULL;
    if (o->work) (void)zt_errand_open(&errand, work, o);
    if (errand) zt_errand_send(errand);
    zt_status opened = zt_output_open(output, o->target, o->format, o->options, o->listener);
    atomic_store(&o->refused, opened != ZT_OK);
    zt_errand_close(&errand);
    return opened != ZT_OK ? opened : o->worked;
}
