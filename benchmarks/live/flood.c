/* flood PORT RATE SECONDS SEED [OWN_PORT]: datagrams to 127.0.0.1:PORT, for flood.py.

   A third is noise, a third begins as frames of a mesh do, a third as sealed ones; 0 to 160 bytes.
   Says how many went, and how many datagrams came back to it. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BATCH = 50, MOST = 160 };

static uint64_t state;

static uint32_t draw(void) {
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (uint32_t)(state >> 16);
}

static double now(void) {
  struct timespec ts;
  clock_gettime(CLOCK_MONOTONIC, &ts);
  return (double)ts.tv_sec + 1e-9 * (double)ts.tv_nsec;
}

int main(int count, char **words) {
  if (count < 5) return 2;
  int sock = socket(AF_INET, SOCK_DGRAM, 0);
  struct sockaddr_in own = {.sin_family = AF_INET}, to = {.sin_family = AF_INET};
  own.sin_addr.s_addr = to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  own.sin_port = htons((uint16_t)(count > 5 ? atoi(words[5]) : 0));
  to.sin_port = htons((uint16_t)atoi(words[1]));
  int yes = 1;
  setsockopt(sock, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (bind(sock, (struct sockaddr *)&own, sizeof own)) return perror("bind"), 1;
  double rate = atof(words[2]), began = now(), ends = began + atof(words[3]);
  state = (uint64_t)atoll(words[4]) * 2654435761u + 88172645463325252u;
  static unsigned char bytes[BATCH][MOST];
  struct iovec parts[BATCH];
  struct mmsghdr all[BATCH] = {0};
  for (int i = 0; i < BATCH; i++) {
    parts[i].iov_base = bytes[i];
    all[i].msg_hdr = (struct msghdr){.msg_name = &to, .msg_namelen = sizeof to,
                                     .msg_iov = &parts[i], .msg_iovlen = 1};
  }
  long sent = 0, back = 0;
  for (double at = now(); at < ends; at = now()) {
    if ((double)sent > rate * (at - began)) {
      nanosleep(&(struct timespec){.tv_nsec = 50000}, NULL);
      continue;
    }
    for (int i = 0; i < BATCH; i++) {
      for (int k = 0; k < MOST; k += 4) {
        uint32_t word = draw();
        memcpy(bytes[i] + k, &word, 4);
      }
      uint32_t kind = draw() % 3;
      if (kind == 1) bytes[i][0] = (unsigned char)(0x40 | (bytes[i][0] & 31));
      if (kind == 2) bytes[i][0] |= 0xC0;
      parts[i].iov_len = draw() % (MOST + 1);
    }
    int went = sendmmsg(sock, all, BATCH, 0);
    if (went > 0) sent += went;
    unsigned char answer[2048];
    while (recv(sock, answer, sizeof answer, MSG_DONTWAIT) >= 0) back++;
  }
  printf("%ld %.0f %ld\n", sent, (double)sent / (now() - began), back);
  return 0;
}
