"""The radio channel of a robot team: medium access without a central station."""
