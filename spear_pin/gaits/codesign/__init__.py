"""Robot and gait designed together: a measure is minimised over any numbers, with exact derivatives."""
