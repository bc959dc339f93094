/* Holds the tracer against the reference where numbers are extreme, and prints how exact and
 * how fast it was:
 *     extremes [--case NAME] [--first N] [--scenes N] [--rays N] [--precision NAME]
 *              [--csv FILE] [--verbose] [--digest]
 * --first: the number of the first scene of each case; --scenes: how many; without both, those
 * of the short run. --rays: how many at edges and corners of closed meshes. --precision: one
 * instead of all three. --verbose prints each mistake, --digest a checksum of all answers
 * instead, for comparisons between kernels. Exits with 1 where what must hold does not. */
#include <stdlib.h>
#include <string.h>

#include "leaks.h"
#include "pictures.h"
#include "table.h"

typedef struct options {
    const char *only, *csv;
    int first, scenes;
    int64_t rays;
    unsigned precisions;
    bool verbose, digest;
} options;

static bool read_precision(options *o, const char *name) {
    for (int i = 0; i < PROBE_PRECISIONS; i++)
        if (strcmp(name, table_precisions[i]) == 0) o->precisions = 1u << i;
    return o->precisions != RUN_ALL_PRECISIONS;
}

static bool read_options(options *o, int count, char **words) {
    for (int i = 1; i < count; i++) {
        const char *next = i + 1 < count ? words[i + 1] : NULL;
        if (strcmp(words[i], "--verbose") == 0)
            o->verbose = true;
        else if (strcmp(words[i], "--digest") == 0)
            o->digest = true;
        else if (strcmp(words[i], "--precision") == 0 && next) {
            if (!read_precision(o, words[++i])) return false;
        } else if (strcmp(words[i], "--case") == 0 && next)
            o->only = words[++i];
        else if (strcmp(words[i], "--csv") == 0 && next)
            o->csv = words[++i];
        else if (strcmp(words[i], "--first") == 0 && next)
            o->first = atoi(words[++i]);
        else if (strcmp(words[i], "--scenes") == 0 && next)
            o->scenes = atoi(words[++i]);
        else if (strcmp(words[i], "--rays") == 0 && next)
            o->rays = atoll(words[++i]);
        else
            return false;
    }
    return true;
}

/* One case; false where the tracer could not be opened. */
static bool run(int *failures, FILE *csv, const extreme_case *c, const options *o) {
    static run_result result;
    run_how how = o->digest ? RUN_ANSWERS : o->verbose ? RUN_TOLD : RUN_JUDGED;
    bool ok;
    if (o->only && strcmp(o->only, c->name) != 0) return true;
    if (c == &leaks_case)
        ok = run_leaks(&result, o->rays, how);
    else if (c == &pictures_case)
        ok = run_pictures(&result, o->scenes > 0 ? o->scenes : 1, how);
    else
        ok = run_case(&result, c, o->first, o->scenes, o->precisions, how);
    if (!ok) return false;
    if (!o->digest)
        *failures += table_case(csv, c, &result);
    else
        for (int i = 0; i < PROBE_PRECISIONS; i++)
            printf("%s %d %016llx\n", c->name, i, (unsigned long long)result.digest[i]);
    return true;
}

int main(int count, char **words) {
    options o = {.first = -1, .rays = 200000, .precisions = RUN_ALL_PRECISIONS};
    if (!read_options(&o, count, words)) {
        fputs("usage: extremes [--case NAME] [--first N] [--scenes N] [--rays N] "
              "[--precision NAME] [--csv FILE] [--verbose] [--digest]\n",
              stderr);
        return 2;
    }
    FILE *csv = o.csv ? fopen(o.csv, "w") : NULL;
    if (o.csv && !csv) {
        perror(o.csv);
        return 3;
    }
    int failures = 0;
    bool ok = true;
    if (!o.digest) table_begin(csv);
    for (int list = 0; cases_all[list] && ok; list++)
        for (const extreme_case *c = cases_all[list]; c->name && ok; c++)
            ok = run(&failures, csv, c, &o);
    ok = ok && run(&failures, csv, &leaks_case, &o) && run(&failures, csv, &pictures_case, &o);
    if (!ok) fputs("the tracer could not be opened\n", stderr);
    if ((csv && fclose(csv)) || !ok) return 3;
    if (failures) printf("%d do not hold\n", failures);
    return failures ? 1 : 0;
}
