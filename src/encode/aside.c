#include "encode/aside.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/diag.h"
#include "base/text.h"

static zt_status refuse(const char *path, const char *why, zt_listener listener) {
    zt_tell(listener, ZT_ERROR, "cannot write %s: %s", path, why);
    return ZT_EFILE;
}

/* Makes each directory of the path that is missing. `path` is the same before and after. */
static zt_status make_directories(char *path, zt_listener listener) {
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        zt_status status = ZT_OK;
        if (mkdir(path, 0777) != 0 && errno != EEXIST) {
            zt_tell(listener, ZT_ERROR, "cannot make the directory %s: %s", path,
                    strerror(errno));
            status = ZT_EFILE;
        }
        *slash = '/';
        ZT_TRY(status);
    }
    return ZT_OK;
}

static zt_status make_file(const char *path, const char *target, zt_listener listener) {
    struct stat found;
    if (stat(target, &found) == 0 && S_ISDIR(found.st_mode))
        return refuse(target, "it is a directory", listener);
    FILE *file = fopen(path, "ab"); /* what is there stays */
    if (!file) return refuse(path, strerror(errno), listener);
    fclose(file);
    return ZT_OK;
}

void zt_aside_forget(zt_aside *aside) {
    free(aside->path);
    free(aside->target);
    *aside = (zt_aside){0};
}

zt_status zt_aside_open_as(zt_aside *aside, const char *target, const char *suffix,
                           zt_listener listener) {
    *aside =
        (zt_aside){.path = zt_text_print("%s%s", target, suffix), .target = strdup(target)};
    zt_status status = ZT_EMEMORY;
    if (aside->path && aside->target) status = make_directories(aside->path, listener);
    if (status == ZT_OK) status = make_file(aside->path, target, listener);
    if (status != ZT_OK) zt_aside_forget(aside);
    return status;
}

zt_status zt_aside_open(zt_aside *aside, const char *target, zt_listener listener) {
    return zt_aside_open_as(aside, target, ".part", listener);
}

zt_status zt_aside_keep(zt_aside *aside, zt_listener listener) {
    zt_status status = ZT_OK;
    if (rename(aside->path, aside->target) != 0) {
        status = refuse(aside->target, strerror(errno), listener);
        unlink(aside->path);
    }
    zt_aside_forget(aside);
    return status;
}

zt_status zt_aside_room(const zt_aside *aside, double bytes, zt_listener listener) {
    struct statvfs disk;
    if (statvfs(aside->path, &disk) != 0) return refuse(aside->path, strerror(errno), listener);
    double room = (double)disk.f_bavail * (double)disk.f_frsize, gigabyte = 1e9;
    if (room >= bytes) return ZT_OK;
    bool hopeless = room < bytes / 4;
    zt_tell(listener, hopeless ? ZT_ERROR : ZT_WARNING,
            "%s %s: about %.3g GB, and the disk has room for %.3g GB",
            hopeless ? "cannot write" : "there may be no room for", aside->target,
            bytes / gigabyte, room / gigabyte);
    return hopeless ? ZT_EFILE : ZT_OK;
}

void zt_aside_leave(zt_aside *aside, zt_listener listener) {
    zt_tell(listener, ZT_NOTE, "what was written is kept as %s", aside->path);
    zt_aside_forget(aside);
}

void zt_aside_drop(zt_aside *aside) {
    if (aside->path) unlink(aside->path);
    zt_aside_forget(aside);
}
