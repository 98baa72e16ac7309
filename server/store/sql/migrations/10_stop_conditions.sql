-- Frames that end on a condition: when they began, why they ended, and how much work each is, as far as can
-- be foreseen. Of frames of before that is not known.
ALTER TABLE frames ADD COLUMN started INTEGER;
ALTER TABLE frames ADD COLUMN stop_reason TEXT;
ALTER TABLE frames ADD COLUMN passes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE frames ADD COLUMN pixel_samples INTEGER NOT NULL DEFAULT 0;
-- What each tile measures, of jobs that decide by it which tiles get further samples.
CREATE TABLE tile_errors (
    job               INTEGER NOT NULL,
    frame             INTEGER NOT NULL,
    tile              INTEGER NOT NULL,
    samples           INTEGER NOT NULL CHECK (samples > 0),
    relative_variance REAL NOT NULL,
    earlier_variance  REAL NOT NULL,
    error_squares     REAL NOT NULL,
    borrowed_variance REAL NOT NULL,
    error_tail        TEXT NOT NULL,
    dropped_samples   INTEGER NOT NULL,
    PRIMARY KEY (job, frame, tile)
) WITHOUT ROWID;
-- A job's passes change on the way now: the sums over the jobs of a state follow.
DROP TRIGGER jobs_recounted;
CREATE TRIGGER jobs_recounted AFTER UPDATE OF state, passes, passes_merged, passes_queued, passes_leased ON jobs
WHEN OLD.state <> NEW.state OR OLD.passes <> NEW.passes OR OLD.passes_merged <> NEW.passes_merged
  OR OLD.passes_queued <> NEW.passes_queued OR OLD.passes_leased <> NEW.passes_leased
BEGIN
    UPDATE job_totals SET
        jobs = jobs + (state = NEW.state) - (state = OLD.state),
        passes = passes + (state = NEW.state) * NEW.passes - (state = OLD.state) * OLD.passes,
        passes_merged = passes_merged + (state = NEW.state) * NEW.passes_merged
                                      - (state = OLD.state) * OLD.passes_merged,
        passes_queued = passes_queued + (state = NEW.state) * NEW.passes_queued
                                      - (state = OLD.state) * OLD.passes_queued,
        passes_leased = passes_leased + (state = NEW.state) * NEW.passes_leased
                                      - (state = OLD.state) * OLD.passes_leased
     WHERE state IN (OLD.state, NEW.state);
END;
