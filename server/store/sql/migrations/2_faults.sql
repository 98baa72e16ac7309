-- What went wrong while samples were taken.
ALTER TABLE jobs ADD COLUMN rejected_paths INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN truncated_paths INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN fault_samples TEXT NOT NULL DEFAULT '';
