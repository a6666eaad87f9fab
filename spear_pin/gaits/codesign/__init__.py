"""Robot and gait designed together: a measure made small over any numbers, where gaits exist, by exact derivatives."""
