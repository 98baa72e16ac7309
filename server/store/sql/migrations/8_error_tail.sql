-- What the interval of a level's error needs, and which pixels hold it. Of levels measured before there is neither.
ALTER TABLE levels ADD COLUMN error_squares REAL NOT NULL DEFAULT 0;
ALTER TABLE levels ADD COLUMN borrowed_variance REAL NOT NULL DEFAULT 0;
ALTER TABLE levels ADD COLUMN error_tail TEXT NOT NULL DEFAULT '';
