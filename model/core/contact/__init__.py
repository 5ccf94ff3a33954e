"""One-sided springs between coils and on the seats (7.1.1); every kind has one interface, `Contact` of base.py."""
