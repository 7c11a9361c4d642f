"""What is remembered: settings, models, repositories, the plan, artifacts."""
