-- Samples of lights without extent that ended at smooth solid glass.
ALTER TABLE jobs ADD COLUMN lights_behind_glass INTEGER NOT NULL DEFAULT 0;
