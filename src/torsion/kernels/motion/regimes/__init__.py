"""One linear motion while all elements keep their regimes, exact at any time, and what ends it. Nothing is marched here."""
