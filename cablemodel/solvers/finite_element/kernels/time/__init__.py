"""Time: schemes, lengths of steps, tension, slack, what a step gives back."""
