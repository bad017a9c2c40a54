"""Rules of classification societies and of IACS. No rule of makers or of general standards.."""
