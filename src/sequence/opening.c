#include "sequence/opening.h"

#include "encode/output.h"

static void open_output(void *user) {
    zt_opening *o = user;
    o->status = zt_output_open(&o->output, o->target, o->format, o->options, o->listener);
    atomic_store(&o->refused, o->status != ZT_OK);
}

bool zt_opening_takes(const zt_opening *o) { return zt_output_module(o->target) != NULL; }

void zt_opening_begin(zt_opening *o) {
    /* Without a thread, it is opened at once. */
    if (zt_opening_takes(o)) (void)zt_errand_open(&o->errand, open_output, o);
    if (o->errand)
        zt_errand_send(o->errand);
    else
        open_output(o);
}

static bool stopped(void *user) {
    zt_opening *o = user;
    const zt_watcher *w = o->watcher;
    return atomic_load(&o->refused) || (w && w->stopped && w->stopped(w->user));
}

zt_watcher zt_opening_watcher(zt_opening *o) {
    return (zt_watcher){.stopped = stopped, .user = o};
}

zt_status zt_opening_end(zt_output **output, zt_opening *o) {
    zt_errand_close(&o->errand);
    *output = o->output;
    return o->status;
}
