"""The kind `compressor`: throws of a reciprocating compressor, whose torque is that of their p-V diagrams."""
