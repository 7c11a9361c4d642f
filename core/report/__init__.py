"""What a run says about itself: tables, quality and summary, from plain records."""
