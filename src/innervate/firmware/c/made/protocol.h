/** @name: a node's protocol, made from @entry.
 *
 * role_init, then role_on_start; from then on the driver calls a handler for
 * everything that happens, carries out what is in the outbox, and calls
 * role_clear.
 * Nothing is allocated; times are microseconds modulo 2^30. */
#ifndef ROLE_H
#define ROLE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ROLE_ABI @abi /* of this header */
#define ROLE_SOURCE "@digest" /* hash of functions and declarations */
#define ROLE_OUTBOX @room /* actions of one call at most */
@outbox
/*+ timers */
#define ROLE_TIMERS_MAX @timers /* timers */
/*- */
/*+ nodes */
#define ROLE_NODES @nodes /* of a network at most */
/*- */

@parts
#ifdef __cplusplus
}
#endif

#endif /* ROLE_H */
