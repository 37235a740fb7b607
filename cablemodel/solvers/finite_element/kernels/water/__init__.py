"""Water: waves, seas, what is wet, flow along a cable that runs."""
