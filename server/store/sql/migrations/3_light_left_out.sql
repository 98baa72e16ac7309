-- How much light was left out, and how much clamping took.
ALTER TABLE jobs ADD COLUMN truncated_throughput REAL NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN clamped_samples INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN clamped_luminance REAL NOT NULL DEFAULT 0;
