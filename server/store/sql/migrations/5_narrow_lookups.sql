-- The early passes of one tile are looked up with every merge, and closed leases are forgotten every
-- minute: neither may look at all others.
CREATE INDEX passes_held_of_tile ON passes(job, frame, tile, first_sample) WHERE held_file IS NOT NULL;
CREATE INDEX leases_closed ON leases(granted) WHERE state <> 'open';
