-- A study and what was measured of each of its cells, a variant at a number of samples. Its jobs are found by
-- their idempotency keys. One without a time of end has jobs to make, to wait for or to cancel.
CREATE TABLE studies (
    key      INTEGER PRIMARY KEY AUTOINCREMENT,
    id       TEXT NOT NULL UNIQUE,
    state    TEXT NOT NULL CHECK (state IN ('running','completed','failed','canceled')),
    request  TEXT NOT NULL,
    created  INTEGER NOT NULL,
    finished INTEGER,
    fault    TEXT NOT NULL
);
CREATE INDEX studies_open ON studies(key) WHERE finished IS NULL;
CREATE TRIGGER studies_move BEFORE UPDATE OF state ON studies
WHEN OLD.state <> NEW.state AND OLD.state <> 'running'
BEGIN SELECT RAISE(ABORT, 'no such move of a study'); END;

CREATE TABLE study_cells (
    study    INTEGER NOT NULL REFERENCES studies(key),
    cell     INTEGER NOT NULL,
    result   TEXT NOT NULL,
    pictures TEXT NOT NULL,
    PRIMARY KEY (study, cell)
) WITHOUT ROWID;
