"""Other protocols for a shared channel [radio 9]: reference models, to compare CSMA/CD-R with."""
