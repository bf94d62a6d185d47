/** Parameters as the network's plainest scenario has them, or as they were given. */
extern const role_params_t role_defaults;

/** A state before its first start: all fields as declared; number says who it is, seed (1 to
 * 1072496638, on every node another, not near each other) begins its random choices. */
void role_init(role_state_t *state, int32_t number, int32_t seed);

/** Empties an outbox, after its actions are carried out and before its first use. */
void role_clear(role_out_t *out);
/*+ frame */

/** The frame of a SEND or DELIVER; 0 if it has none. */
const role_frame_t *role_frame_of(const role_out_t *out, int32_t action);
/*- */
/*+ gate */

/** The second record before the first start. */
void role_init_gate(role_gate_t *gate);
/*- */
