/* flood HOST PORT RATE SECONDS SEED [AS_PORT RECORDING]: datagrams to HOST:PORT, for flood.py.

   A third is noise, a third begins as frames of a mesh do, a third as sealed ones; 0 to 160 bytes.
   With AS_PORT they bear the address 127.0.0.1:AS_PORT (as root). With a recording (each frame as
   its length in two bytes, little-endian, and itself) a third is noise, a third are recorded frames
   with one byte changed, and a third begin as recorded ones do and go on with noise; the counters
   of sealed ones go on twice as fast as in the recording, a second of it, so that they are new.
   Says how many went, and how many datagrams came back to it. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { BATCH = 50, MOST = 160, RECORDED = 1024, HEAD = 9, SEALED = 0xC0 };

struct headers {
  struct iphdr ip;
  struct udphdr udp;
};

struct frame {
  unsigned char bytes[MOST];
  size_t count;
};

static uint64_t state;
static struct frame recorded[RECORDED];
static unsigned known;
static uint32_t first_counter, per_s;

static uint32_t draw(void) {
  state ^= state << 13, state ^= state >> 7, state ^= state << 17;
  return (uint32_t)(state >> 16);
}

static double now(void) {
  struct timespec ts;
  clock_gettime(CLOCK_MONOTONIC, &ts);
  return (double)ts.tv_sec + 1e-9 * (double)ts.tv_nsec;
}

static uint32_t counter_of(const struct frame *frame) {
  uint32_t raw;
  memcpy(&raw, frame->bytes + 5, 4);
  return ntohl(raw);
}

static int read_recording(const char *name) {
  FILE *file = fopen(name, "rb");
  unsigned char size[2];
  if (!file) return perror(name), 1;
  while (known < RECORDED && fread(size, 1, 2, file) == 2) {
    struct frame *frame = &recorded[known];
    frame->count = size[0] | (size_t)size[1] << 8;
    if (frame->count > MOST || fread(frame->bytes, 1, frame->count, file) != frame->count) break;
    if (frame->count >= HEAD) known++;
  }
  fclose(file);
  if (!known) return fprintf(stderr, "%s: nothing was recorded\n", name), 1;
  first_counter = counter_of(&recorded[known - 1]);
  per_s = first_counter - counter_of(&recorded[0]);
  return 0;
}

static size_t like_recorded(unsigned char *bytes, int is_changed, double seconds) {
  const struct frame *frame = &recorded[draw() % known];
  if (is_changed) {
    memcpy(bytes, frame->bytes, frame->count);
    bytes[draw() % frame->count] ^= (unsigned char)(1 + draw() % 255);
    return frame->count;
  }
  memcpy(bytes, frame->bytes, HEAD);
  if (bytes[0] >= SEALED) {
    uint32_t counter = htonl(first_counter + (uint32_t)(2 * per_s * seconds) + draw() % 1000);
    memcpy(bytes + 5, &counter, 4);
  }
  return frame->count;
}

static size_t fill(unsigned char *bytes, double seconds) {
  for (int k = 0; k < MOST; k += 4) {
    uint32_t word = draw();
    memcpy(bytes + k, &word, 4);
  }
  uint32_t kind = draw() % 3;
  if (known && kind) return like_recorded(bytes, kind == 1, seconds);
  if (kind == 1) bytes[0] = (unsigned char)(0x40 | (bytes[0] & 31));
  if (kind == 2) bytes[0] |= SEALED;
  return draw() % (MOST + 1);
}

int main(int count, char **words) {
  if (count < 6 || (count > 7 && read_recording(words[7]))) return 2;
  in_port_t as = htons((uint16_t)(count > 6 ? atoi(words[6]) : 0));
  int sock = socket(AF_INET, as ? SOCK_RAW : SOCK_DGRAM, as ? IPPROTO_RAW : 0);
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(words[2]))};
  to.sin_addr.s_addr = inet_addr(words[1]);
  if (sock < 0) return perror("socket"), 1;
  double rate = atof(words[3]), began = now(), ends = began + atof(words[4]);
  state = (uint64_t)atoll(words[5]) * 2654435761u + 88172645463325252u;
  static unsigned char bytes[BATCH][MOST];
  static struct headers heads[BATCH];
  struct iovec parts[BATCH][2];
  struct mmsghdr all[BATCH] = {0};
  struct in_addr own = {htonl(INADDR_LOOPBACK)};
  setsockopt(sock, IPPROTO_IP, IP_MULTICAST_IF, &own, sizeof own);
  for (int i = 0; i < BATCH; i++) {
    heads[i].ip = (struct iphdr){.version = 4, .ihl = 5, .ttl = 64, .protocol = IPPROTO_UDP,
                                 .saddr = own.s_addr, .daddr = to.sin_addr.s_addr};
    heads[i].udp = (struct udphdr){.source = as, .dest = to.sin_port};
    parts[i][0] = (struct iovec){&heads[i], as ? sizeof heads[i] : 0};
    parts[i][1].iov_base = bytes[i];
    all[i].msg_hdr = (struct msghdr){.msg_name = &to, .msg_namelen = sizeof to,
                                     .msg_iov = parts[i], .msg_iovlen = 2};
  }
  long sent = 0, back = 0;
  for (double at = now(); at < ends; at = now()) {
    if ((double)sent > rate * (at - began)) {
      nanosleep(&(struct timespec){.tv_nsec = 50000}, NULL);
      continue;
    }
    for (int i = 0; i < BATCH; i++) {
      parts[i][1].iov_len = fill(bytes[i], at - began);
      heads[i].udp.len = htons((uint16_t)(sizeof(struct udphdr) + parts[i][1].iov_len));
    }
    int went = sendmmsg(sock, all, BATCH, 0);
    if (went > 0) sent += went;
    unsigned char answer[2048];
    while (!as && recv(sock, answer, sizeof answer, MSG_DONTWAIT) >= 0) back++;
  }
  printf("%ld %.0f %ld\n", sent, (double)sent / (now() - began), back);
  return 0;
}
