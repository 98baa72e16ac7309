-- Workers that ended while they held passes, and jobs that are set aside for it. Deaths of a pass lie in
-- the order in which passes are handed out.
ALTER TABLE jobs ADD COLUMN suspect_frame INTEGER;
ALTER TABLE jobs ADD COLUMN died_on TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN set_aside TEXT NOT NULL DEFAULT '';
ALTER TABLE leases ADD COLUMN session TEXT NOT NULL DEFAULT '';
ALTER TABLE leases ADD COLUMN machine TEXT NOT NULL DEFAULT '';
ALTER TABLE leases ADD COLUMN loss TEXT NOT NULL DEFAULT 'none' CHECK (loss IN ('none','counted','shared'));
CREATE INDEX leases_lost ON leases(epoch) WHERE loss <> 'none';
CREATE TABLE deaths (
    job          INTEGER NOT NULL,
    frame        INTEGER NOT NULL,
    first_sample INTEGER NOT NULL,
    tile         INTEGER NOT NULL,
    deaths       INTEGER NOT NULL CHECK (deaths >= 0),
    PRIMARY KEY (job, frame, first_sample, tile)
) WITHOUT ROWID;
