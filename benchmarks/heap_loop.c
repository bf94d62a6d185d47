/* What a plain tight C loop can do: one pop and one push of a heap per event, nothing else.
 *
 *   heap_loop ARITY PENDING SECONDS      prints events per second
 *
 * Keys are 64-bit times in microseconds with a 32-bit payload, as in a simulator's event queue.
 * The pushed event lies an exponential time ahead (a table of 4096 values, so that no logarithm is
 * timed), hence the number of pending events stays what it is.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef struct {
    uint64_t time;
    uint32_t node;
} event;

enum { STEPS = 4096, CHUNK = 1 << 16 };

static uint32_t ahead[STEPS];
static uint64_t random_state = 88172645463325252u;

static inline uint32_t draw(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (uint32_t)(random_state >> 40) & (STEPS - 1);
}

static inline void sift_up(event *heap, size_t at, event e, const size_t arity)
{
    while (at > 0) {
        size_t above = (at - 1) / arity;
        if (heap[above].time <= e.time)
            break;
        heap[at] = heap[above];
        at = above;
    }
    heap[at] = e;
}

static inline void sift_down(event *heap, size_t count, event e, const size_t arity)
{
    size_t at = 0;
    for (;;) {
        size_t first = at * arity + 1;
        if (first >= count)
            break;
        size_t last = first + arity < count ? first + arity : count;
        size_t least = first;
        for (size_t i = first + 1; i < last; i++)
            if (heap[i].time < heap[least].time)
                least = i;
        if (heap[least].time >= e.time)
            break;
        heap[at] = heap[least];
        at = least;
    }
    heap[at] = e;
}

/* Events that came out before an earlier one; 0, or the heap is wrong. Inlined with a constant
 * arity, so that the division is a shift and the inner loop unrolled. */
static inline uint64_t run_chunk(event *heap, size_t count, const size_t arity)
{
    uint64_t disorder = 0, before = 0;
    for (int i = 0; i < CHUNK; i++) {
        event e = heap[0];
        disorder += e.time < before;
        before = e.time;
        event last = heap[count - 1];
        sift_down(heap, count - 1, last, arity);
        e.time += ahead[draw()];
        sift_up(heap, count - 1, e, arity);
    }
    return disorder;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "usage: heap_loop ARITY PENDING SECONDS\n");
        return 2;
    }
    int arity = atoi(argv[1]);
    size_t pending = (size_t)atol(argv[2]);
    double seconds = atof(argv[3]);
    event *heap = malloc(pending * sizeof *heap);
    if ((arity != 2 && arity != 4) || pending < 1 || heap == NULL) {
        fprintf(stderr, "heap_loop: arity is 2 or 4, pending at least 1\n");
        return 2;
    }
    for (int i = 0; i < STEPS; i++)
        ahead[i] = 1 + (uint32_t)(-4000.0 * log((i + 0.5) / STEPS));
    for (size_t i = 0; i < pending; i++)
        sift_up(heap, i, (event){ahead[draw()], (uint32_t)i}, (size_t)arity);

    uint64_t events = 0, disorder = 0;
    double start = now(), end;
    do {
        disorder += arity == 2 ? run_chunk(heap, pending, 2) : run_chunk(heap, pending, 4);
        events += CHUNK;
        end = now();
    } while (end - start < seconds);
    free(heap);
    if (disorder) {
        fprintf(stderr, "heap_loop: events out of order\n");
        return 1;
    }
    printf("%.0f\n", events / (end - start));
    return 0;
}
