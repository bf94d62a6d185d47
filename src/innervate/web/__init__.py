"""The live page: a network that is simulated, recorded or running, to watch and to break."""
