/* The time of day of one node, for soak.py: LD_PRELOAD=clock.so.
   NAME.clock beside NAME.toml, the last argument, holds how many nanoseconds to add (int64). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static volatile const int64_t *ahead_ns;
static int (*real)(clockid_t, struct timespec *);

__attribute__((constructor)) static void begin(void) {
  char line[4096] = {0}, *name = line;
  real = dlsym(RTLD_NEXT, "clock_gettime");
  int fd = open("/proc/self/cmdline", O_RDONLY);
  ssize_t n = fd < 0 ? 0 : read(fd, line, sizeof line - 2);
  if (fd >= 0) close(fd);
  for (ssize_t i = 0; i + 1 < n; i++)
    if (!line[i]) name = line + i + 1;
  char *end = strstr(name, ".toml");
  if (!end) return;
  strcpy(end, ".clock");
  fd = open(name, O_RDONLY);
  if (fd < 0) return;
  void *at = mmap(NULL, sizeof *ahead_ns, PROT_READ, MAP_SHARED, fd, 0);
  close(fd);
  if (at != MAP_FAILED) ahead_ns = at;
}

int clock_gettime(clockid_t clock, struct timespec *now) {
  int rc = real(clock, now);
  if (rc == 0 && clock == CLOCK_REALTIME && ahead_ns) {
    int64_t ns = now->tv_nsec + *ahead_ns;
    now->tv_sec += ns / 1000000000;
    now->tv_nsec = ns % 1000000000;
    if (now->tv_nsec < 0) now->tv_nsec += 1000000000, now->tv_sec--;
  }
  return rc;
}

int gettimeofday(struct timeval *restrict now, void *restrict zone) {
  struct timespec ts;
  (void)zone;
  int rc = clock_gettime(CLOCK_REALTIME, &ts);
  now->tv_sec = ts.tv_sec, now->tv_usec = ts.tv_nsec / 1000;
  return rc;
}

time_t time(time_t *at) {
  struct timespec ts;
  clock_gettime(CLOCK_REALTIME, &ts);
  if (at) *at = ts.tv_sec;
  return ts.tv_sec;
}
