/** Frames of role on the wire, made from its layouts. */
#ifndef ROLE_WIRE_H
#define ROLE_WIRE_H

#include "role.h"

#ifdef __cplusplus
extern "C" {
#endif

/*+ payload */
#ifndef ROLE_PAYLOAD_MAX
#define ROLE_PAYLOAD_MAX @payload_max /* bytes of a payload */
#endif
#define ROLE_PAYLOAD_AT @payload_at /* where it begins */
/*- */
#define ROLE_SIZE_MAX @size_max /* bytes of the longest frame */
#define ROLE_SIZE_MIN @size_min /* of the shortest */

/* What role_decode says: read, or why not. */
@reasons

/** Bytes of a frame on the wire; 0 if there is no such frame. */
int32_t role_size(const role_frame_t *frame);

/** The bytes of a frame, ROLE_SIZE_MAX at most; how many, 0 if there is no such
 * frame. Bits that a field has too many of are left out. */
int32_t role_encode(const role_frame_t *frame, @givenuint8_t *data);

/** Reads received bytes into a frame; any bytes at all will do. Sets `kind` and the
 * fields of that kind. Returns ROLE_OK, or else why not, with the frame as it
 * was. */
int32_t role_decode(const uint8_t *data, int32_t size, role_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif /* ROLE_WIRE_H */
