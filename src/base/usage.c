#include "base/usage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double seconds_of(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double zt_usage_cpu_s(void) { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }
double zt_usage_own_s(void) { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

/* Linux tells of the peak in a line of this file, "VmHWM:   1234 kB". */
int64_t zt_usage_peak(void) {
    FILE *file = fopen("/proc/self/status", "r");
    char line[256];
    int64_t kib = 0;
    while (kib == 0 && file && fgets(line, sizeof line, file))
        if (strncmp(line, "VmHWM:", 6) == 0) kib = strtoll(line + 6, NULL, 10);
    if (file) fclose(file);
    struct rusage usage;
    if (kib == 0 && getrusage(RUSAGE_SELF, &usage) == 0) kib = usage.ru_maxrss;
    return kib * 1024;
}

/* And forgets it when told to by this number (proc(5), clear_refs). */
void zt_usage_forget_peak(void) {
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (!file) return;
    fputs("5", file);
    fclose(file);
}
