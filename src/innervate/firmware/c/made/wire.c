/* Frames of role on the wire, most significant bit first. */
#include "role_wire.h"
#include "innervate_wire.h"

/*+ payloads */
/* 1 if bits `at` to `end` are exactly a payload of this kind. */
static int32_t role_is_whole(const uint8_t *data, int32_t kind, int32_t at, int32_t end)
{
    int32_t count;
    switch (kind) {
@cases
    default:
        return 0;
    }
}

/* 1 if bytes `at` to `end` are a payload, and what forwarding puts around. */
static int32_t role_fits(const uint8_t *data, int32_t at, int32_t end)
{
    const int32_t kind = data[0] & @kind_mask;
    const int32_t flags = data[@flags_at];
    int32_t begin = at;
/*+ lead */
    if ((flags & @lead) && at < end) {
        begin = at + 1 + data[at];
    }
/*- */
/*+ trail */
    if ((flags & @trail) && begin < end && data[end - 1] > 0 &&
            role_is_whole(data, kind, 8 * begin, 8 * (end - 1 - data[end - 1]))) {
        return 1;
    }
/*- */
    return role_is_whole(data, kind, 8 * begin, 8 * end);
}

/*- */
int32_t role_size(const role_frame_t *frame)
{
/*+ alone */
    if (frame->kind == @alone_kind) {
        return 1;
    }
/*- */
@sizes
}

int32_t role_encode(const role_frame_t *frame, @givenuint8_t *data)
{
    const int32_t size = role_size(frame)@more;
    innervate_bits_t place = {0, 0};
    place.data = data;
/*+ alone */
    if (frame->kind == @alone_kind) {
        data[0] = @alone_byte;
        return 1;
    }
/*- */
    if (size == @nothing || size > ROLE_SIZE_MAX) {
        return 0;
    }
    for (int32_t i = 0; i < size; i++) {
        data[i] = 0;
    }
/*+ version */
    innervate_put(&place, @version_bits, @version);
/*- */
    innervate_put(&place, @kind_bits, frame->kind);
@puts
    innervate_seal_crc(data, size);
    return size;
}

/* OK if these bytes are a frame, else why not. */
static int32_t role_reason(const uint8_t *data, int32_t size)
{
    int32_t at = 0;
/*+ alone */
    if (size == 1) {
        return data[0] == @alone_byte ? ROLE_OK : ROLE_BAD_KIND;
    }
/*- */
    if (size < @least || size > ROLE_SIZE_MAX) {
        return ROLE_BAD_LENGTH;
    }
    if (!innervate_is_sound(data, size)) {
        return ROLE_BAD_CRC;
    }
/*+ version */
    if (innervate_get(data, &at, @version_bits) != @version) {
        return ROLE_BAD_VERSION;
    }
/*- */
@lengths
}

int32_t role_decode(const uint8_t *data, int32_t size, role_frame_t *frame)
{
    int32_t at = @from;
    const int32_t why = role_reason(data, size);
    if (why != ROLE_OK) {
        return why;
    }
/*+ version */
    for (uint32_t i = 0; i < sizeof *frame; i++) {
        ((uint8_t *)frame)[i] = 0;
    }
/*- */
/*+ alone */
    if (size == 1) {
@alone_fields
        return ROLE_OK;
    }
/*- */
    frame->kind = (@kind_type)innervate_get(data, &at, @kind_bits);
@gets
    return ROLE_OK;
}
