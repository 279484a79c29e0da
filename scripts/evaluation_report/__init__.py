"""What scripts/draw_evaluation draws with."""
