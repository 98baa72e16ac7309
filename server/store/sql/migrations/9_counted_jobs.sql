-- The text of a job may be megabytes: it lies apart, so that a look at its row costs the row. The row keeps
-- an outline, the same text with the entry alone of its scene's files.
CREATE TABLE specs (
    job  INTEGER PRIMARY KEY REFERENCES jobs(key),
    json TEXT NOT NULL
);
INSERT INTO specs (job, json) SELECT key, spec FROM jobs;
ALTER TABLE jobs ADD COLUMN outline TEXT NOT NULL DEFAULT '{}';
UPDATE jobs SET outline = CASE
    WHEN json_extract(spec, '$.scene.entry') IS NULL THEN spec
    ELSE json_set(spec, '$.scene.files', json_object(json_extract(spec, '$.scene.entry'),
        (SELECT value FROM json_each(spec, '$.scene.files') WHERE key = json_extract(spec, '$.scene.entry'))))
    END;
ALTER TABLE jobs DROP COLUMN spec;

-- Sums over a job's frames, and over the jobs of a state. Triggers keep them, so that nobody counts rows.
ALTER TABLE jobs ADD COLUMN passes_queued INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN passes_leased INTEGER NOT NULL DEFAULT 0;
UPDATE jobs SET (passes_queued, passes_leased) = (
    SELECT coalesce(sum(passes_queued), 0), coalesce(sum(passes_leased), 0) FROM frames WHERE job = key);
CREATE TRIGGER frames_counted AFTER INSERT ON frames
WHEN NEW.passes_queued <> 0 OR NEW.passes_leased <> 0
BEGIN
    UPDATE jobs SET passes_queued = passes_queued + NEW.passes_queued,
                    passes_leased = passes_leased + NEW.passes_leased
     WHERE key = NEW.job;
END;
CREATE TRIGGER frames_recounted AFTER UPDATE OF passes_queued, passes_leased ON frames
WHEN OLD.passes_queued <> NEW.passes_queued OR OLD.passes_leased <> NEW.passes_leased
BEGIN
    UPDATE jobs SET passes_queued = passes_queued + NEW.passes_queued - OLD.passes_queued,
                    passes_leased = passes_leased + NEW.passes_leased - OLD.passes_leased
     WHERE key = NEW.job;
END;

CREATE TABLE job_totals (
    state         TEXT PRIMARY KEY,
    jobs          INTEGER NOT NULL DEFAULT 0,
    passes        INTEGER NOT NULL DEFAULT 0,
    passes_merged INTEGER NOT NULL DEFAULT 0,
    passes_queued INTEGER NOT NULL DEFAULT 0,
    passes_leased INTEGER NOT NULL DEFAULT 0
) WITHOUT ROWID;
INSERT INTO job_totals (state)
VALUES ('queued'), ('running'), ('paused'), ('completed'), ('failed'), ('canceled');
UPDATE job_totals SET (jobs, passes, passes_merged, passes_queued, passes_leased) = (
    SELECT count(*), coalesce(sum(j.passes), 0), coalesce(sum(j.passes_merged), 0),
           coalesce(sum(j.passes_queued), 0), coalesce(sum(j.passes_leased), 0)
      FROM jobs AS j WHERE j.state = job_totals.state);
CREATE TRIGGER jobs_counted AFTER INSERT ON jobs
BEGIN
    UPDATE job_totals SET jobs = jobs + 1, passes = passes + NEW.passes,
                          passes_merged = passes_merged + NEW.passes_merged,
                          passes_queued = passes_queued + NEW.passes_queued,
                          passes_leased = passes_leased + NEW.passes_leased
     WHERE state = NEW.state;
END;
CREATE TRIGGER jobs_recounted AFTER UPDATE OF state, passes_merged, passes_queued, passes_leased ON jobs
WHEN OLD.state <> NEW.state OR OLD.passes_merged <> NEW.passes_merged
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

-- Only what has free work: a worker is not shown jobs and frames that are wholly on loan. SQLite turns
-- `expression < column` round before it looks for an index, so that the index has to say it this way.
DROP INDEX jobs_leasable;
CREATE INDEX jobs_leasable ON jobs(priority DESC, key)
 WHERE state IN ('queued','running') AND passes > passes_merged + passes_leased;
CREATE INDEX frames_with_work ON frames(job, frame)
 WHERE state = 'active' AND (passes_queued > 0 OR levels_created < levels);

-- The oldest by its own index; the order of handing out does not need the time.
DROP INDEX passes_queued;
CREATE INDEX passes_queued ON passes(job, frame, first_sample, tile) WHERE state = 'queued';
CREATE INDEX passes_oldest ON passes(queued_at) WHERE state = 'queued';
