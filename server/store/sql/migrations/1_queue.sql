-- The rules of shared/job/states.h stand here a second time, as triggers; a contract test holds the two
-- together. Times are milliseconds since the Unix epoch.
CREATE TABLE jobs (
    key             INTEGER PRIMARY KEY AUTOINCREMENT,
    id              TEXT NOT NULL UNIQUE,
    state           TEXT NOT NULL CHECK (state IN ('queued','running','paused','completed','failed','canceled')),
    priority        INTEGER NOT NULL CHECK (priority BETWEEN 0 AND 100),
    spec            TEXT NOT NULL,
    idempotency_key TEXT UNIQUE,
    body_digest     TEXT NOT NULL,
    created         INTEGER NOT NULL,
    started         INTEGER,
    finished        INTEGER,
    passes          INTEGER NOT NULL CHECK (passes > 0),
    passes_merged   INTEGER NOT NULL CHECK (passes_merged BETWEEN 0 AND passes),
    pixel_samples        INTEGER NOT NULL,
    pixel_samples_merged INTEGER NOT NULL CHECK (pixel_samples_merged BETWEEN 0 AND pixel_samples),
    frames          INTEGER NOT NULL CHECK (frames > 0),
    frames_started  INTEGER NOT NULL CHECK (frames_started BETWEEN 0 AND frames),
    frames_done     INTEGER NOT NULL CHECK (frames_done BETWEEN 0 AND frames_started),
    samples_merged  INTEGER NOT NULL,
    relative_error  REAL,
    device_seconds  REAL NOT NULL CHECK (device_seconds >= 0),
    dropped_samples INTEGER NOT NULL,
    faults          TEXT NOT NULL
);
CREATE INDEX jobs_by_state ON jobs(state, key);
CREATE INDEX jobs_leasable ON jobs(priority DESC, key) WHERE state IN ('queued','running');
CREATE TRIGGER jobs_move BEFORE UPDATE OF state ON jobs
WHEN OLD.state <> NEW.state AND (OLD.state || '>' || NEW.state) NOT IN (
    'queued>running','queued>paused','queued>canceled',
    'running>completed','running>failed','running>paused','running>canceled',
    'paused>queued','paused>running','paused>completed','paused>failed','paused>canceled')
BEGIN SELECT RAISE(ABORT, 'no such move of a job'); END;

CREATE TABLE frames (
    job             INTEGER NOT NULL REFERENCES jobs(key),
    frame           INTEGER NOT NULL,
    state           TEXT NOT NULL CHECK (state IN ('active','finishing','completed')),
    levels          INTEGER NOT NULL,
    levels_created  INTEGER NOT NULL CHECK (levels_created BETWEEN 0 AND levels),
    tiles           INTEGER NOT NULL CHECK (tiles > 0),
    passes_merged   INTEGER NOT NULL CHECK (passes_merged BETWEEN 0 AND tiles * levels),
    passes_queued   INTEGER NOT NULL CHECK (passes_queued >= 0),
    passes_leased   INTEGER NOT NULL CHECK (passes_leased >= 0),
    samples_merged  INTEGER NOT NULL,
    relative_error  REAL,
    device_seconds  REAL NOT NULL CHECK (device_seconds >= 0),
    dropped_samples INTEGER NOT NULL,
    revision        INTEGER NOT NULL,
    exr_sha256      TEXT NOT NULL,
    exr_bytes       INTEGER NOT NULL,
    PRIMARY KEY (job, frame)
) WITHOUT ROWID;
CREATE INDEX frames_by_state ON frames(state, job, frame);

CREATE TABLE tiles (
    job            INTEGER NOT NULL,
    frame          INTEGER NOT NULL,
    tile           INTEGER NOT NULL,
    slot           INTEGER NOT NULL CHECK (slot IN (0, 1)),
    merged_samples INTEGER NOT NULL CHECK (merged_samples >= 0),
    PRIMARY KEY (job, frame, tile),
    FOREIGN KEY (job, frame) REFERENCES frames(job, frame)
) WITHOUT ROWID;
CREATE TRIGGER tiles_keep BEFORE UPDATE OF merged_samples ON tiles
WHEN NEW.merged_samples < OLD.merged_samples
BEGIN SELECT RAISE(ABORT, 'merged samples are never given up'); END;

-- In the order in which they are handed out: level by level, tiles within a level.
CREATE TABLE passes (
    job          INTEGER NOT NULL,
    frame        INTEGER NOT NULL,
    first_sample INTEGER NOT NULL CHECK (first_sample >= 0),
    tile         INTEGER NOT NULL,
    samples      INTEGER NOT NULL CHECK (samples > 0),
    state        TEXT NOT NULL CHECK (state IN ('queued','leased','merged','failed')),
    epoch        INTEGER NOT NULL,
    held_file    TEXT,
    held_offset  INTEGER,
    queued_at    INTEGER NOT NULL,
    PRIMARY KEY (job, frame, first_sample, tile),
    UNIQUE (job, frame, tile, first_sample),
    CHECK (held_file IS NULL OR state = 'merged'),
    CHECK (state <> 'leased' OR epoch > 0)
) WITHOUT ROWID;
CREATE INDEX passes_queued ON passes(job, frame, first_sample, tile, queued_at) WHERE state = 'queued';
CREATE INDEX passes_leased ON passes(epoch) WHERE state = 'leased';
CREATE INDEX passes_held ON passes(held_file) WHERE held_file IS NOT NULL;
CREATE TRIGGER passes_move BEFORE UPDATE OF state ON passes
WHEN OLD.state <> NEW.state AND (OLD.state || '>' || NEW.state) NOT IN (
    'queued>leased','queued>merged','leased>queued','leased>merged','leased>failed')
BEGIN SELECT RAISE(ABORT, 'no such move of a pass'); END;

CREATE TABLE leases (
    epoch   INTEGER PRIMARY KEY AUTOINCREMENT,
    id      TEXT NOT NULL UNIQUE,
    worker  TEXT NOT NULL,
    job     INTEGER NOT NULL,
    frame   INTEGER NOT NULL,
    state   TEXT NOT NULL CHECK (state IN ('open','merged','expired','returned','failed','revoked')),
    granted INTEGER NOT NULL,
    passes  BLOB NOT NULL
);
CREATE INDEX leases_open ON leases(epoch) WHERE state = 'open';

CREATE TABLE failures (
    job          INTEGER NOT NULL,
    frame        INTEGER NOT NULL,
    tile         INTEGER NOT NULL,
    first_sample INTEGER NOT NULL,
    worker       TEXT NOT NULL,
    message      TEXT NOT NULL,
    reports      INTEGER NOT NULL,
    PRIMARY KEY (job, frame, tile, first_sample, worker)
) WITHOUT ROWID;
CREATE INDEX failures_by_worker ON failures(worker, job);

CREATE TABLE workers (
    worker     TEXT PRIMARY KEY,
    host       TEXT NOT NULL,
    device     TEXT NOT NULL,
    driver     TEXT NOT NULL,
    version    TEXT NOT NULL,
    state      TEXT NOT NULL CHECK (state IN ('online','draining','parked','quarantined','offline')),
    reason     TEXT NOT NULL,
    first_seen INTEGER NOT NULL,
    last_seen  INTEGER NOT NULL
) WITHOUT ROWID;

CREATE TABLE contributions (
    job            INTEGER NOT NULL,
    worker         TEXT NOT NULL,
    device_seconds REAL NOT NULL,
    passes         INTEGER NOT NULL,
    samples        INTEGER NOT NULL,
    PRIMARY KEY (job, worker)
) WITHOUT ROWID;

CREATE TABLE reports (
    job    INTEGER NOT NULL,
    worker TEXT NOT NULL,
    json   TEXT NOT NULL,
    PRIMARY KEY (job, worker)
) WITHOUT ROWID;

CREATE TABLE levels (
    job               INTEGER NOT NULL,
    frame             INTEGER NOT NULL,
    samples           INTEGER NOT NULL CHECK (samples > 0),
    tiles             INTEGER NOT NULL,
    relative_variance REAL NOT NULL,
    dropped_samples   INTEGER NOT NULL,
    relative_error    REAL,
    device_seconds    REAL,
    PRIMARY KEY (job, frame, samples)
) WITHOUT ROWID;

CREATE TABLE events (
    id     INTEGER PRIMARY KEY AUTOINCREMENT,
    job    INTEGER NOT NULL,
    job_id TEXT NOT NULL,
    at     INTEGER NOT NULL,
    type   TEXT NOT NULL,
    json   TEXT NOT NULL
);
CREATE INDEX events_of_job ON events(job, id);
