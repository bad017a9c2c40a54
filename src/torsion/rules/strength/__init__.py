"""Rules on the strength of parts: fillets, hubs, teeth and the greatest torque of a motion. No rule of a society."""
