-- What clamping left, so that what it took is a share of something.
ALTER TABLE jobs ADD COLUMN kept_luminance REAL NOT NULL DEFAULT 0;
