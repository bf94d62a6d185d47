
void innervate_@name(role_state_t *state, @gate_givenconst role_params_t *params, int32_t now,
        @given, role_out_t *out);
void innervate_@name(role_state_t *state, @gate_givenconst role_params_t *params, int32_t now,
        @given, role_out_t *out)
{
    role_clear(out);
    role_@name(state, @gate_passedparams, now, @passed, out);
}
