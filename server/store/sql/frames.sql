-- name: find
SELECT * FROM frames WHERE job = :job AND frame = :frame;

-- name: list
SELECT * FROM frames WHERE job = :job ORDER BY frame;

-- name: listByState
SELECT * FROM frames WHERE state = :state ORDER BY job, frame;

-- name: listActive
SELECT * FROM frames INDEXED BY frames_by_state
 WHERE state = 'active' AND job = :job ORDER BY frame;

-- name: listWithWork
SELECT * FROM frames INDEXED BY frames_with_work
 WHERE job = :job AND state = 'active' AND (passes_queued > 0 OR levels_created < levels) ORDER BY frame;

-- name: countActive
SELECT count(*) AS frames FROM frames INDEXED BY frames_by_state WHERE state = 'active' AND job = :job;

-- name: insert
INSERT INTO frames (
    job, frame, state, levels, levels_created, tiles, passes_merged, passes_queued, passes_leased,
    samples_merged, relative_error, device_seconds, dropped_samples, revision, exr_sha256, exr_bytes,
    started, stop_reason, passes, pixel_samples, forecast_at, forecast_seconds, forecast_low, forecast_high)
VALUES (
    :job, :frame, :state, :levels, :levels_created, :tiles, :passes_merged, :passes_queued, :passes_leased,
    :samples_merged, :relative_error, :device_seconds, :dropped_samples, :revision, :exr_sha256, :exr_bytes,
    :started, :stop_reason, :passes, :pixel_samples, :forecast_at, :forecast_seconds, :forecast_low,
    :forecast_high);

-- name: update
UPDATE frames SET
    state = :state, levels_created = :levels_created, passes_merged = :passes_merged,
    passes_queued = :passes_queued, passes_leased = :passes_leased, samples_merged = :samples_merged,
    relative_error = :relative_error, device_seconds = :device_seconds,
    dropped_samples = :dropped_samples, revision = :revision,
    exr_sha256 = :exr_sha256, exr_bytes = :exr_bytes,
    stop_reason = :stop_reason, passes = :passes, pixel_samples = :pixel_samples,
    forecast_at = :forecast_at, forecast_seconds = :forecast_seconds, forecast_low = :forecast_low,
    forecast_high = :forecast_high
 WHERE job = :job AND frame = :frame;

-- name: work
SELECT coalesce(sum(passes), 0) AS passes, coalesce(sum(pixel_samples), 0) AS pixel_samples
  FROM frames WHERE job = :job;

-- name: insertTiles
WITH RECURSIVE t(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM t WHERE i + 1 < :tiles)
INSERT INTO tiles (job, frame, tile, slot, merged_samples) SELECT :job, :frame, i, 0, 0 FROM t;

-- name: tile
SELECT * FROM tiles WHERE job = :job AND frame = :frame AND tile = :tile;

-- name: tiles
SELECT * FROM tiles WHERE job = :job AND frame = :frame ORDER BY tile;

-- name: updateTile
UPDATE tiles SET slot = :slot, merged_samples = :merged_samples
 WHERE job = :job AND frame = :frame AND tile = :tile;

-- name: dropTiles
DELETE FROM tiles WHERE job = :job AND frame = :frame;

-- name: tileError
SELECT * FROM tile_errors WHERE job = :job AND frame = :frame AND tile = :tile;

-- name: tileErrors
SELECT * FROM tile_errors WHERE job = :job AND frame = :frame ORDER BY tile;

-- name: putTileError
INSERT OR REPLACE INTO tile_errors (
    job, frame, tile, samples, relative_variance, earlier_variance, error_squares, borrowed_variance, error_tail,
    dropped_samples)
VALUES (
    :job, :frame, :tile, :samples, :relative_variance, :earlier_variance, :error_squares, :borrowed_variance,
    :error_tail, :dropped_samples);

-- name: dropTileErrors
DELETE FROM tile_errors WHERE job = :job AND frame = :frame;

-- name: level
SELECT * FROM levels WHERE job = :job AND frame = :frame AND samples = :samples;

-- name: levels
SELECT * FROM levels WHERE job = :job AND frame = :frame ORDER BY samples;

-- name: putLevel
INSERT OR REPLACE INTO levels (
    job, frame, samples, tiles, relative_variance, error_squares, borrowed_variance, error_tail, dropped_samples,
    relative_error, device_seconds)
VALUES (
    :job, :frame, :samples, :tiles, :relative_variance, :error_squares, :borrowed_variance, :error_tail,
    :dropped_samples, :relative_error, :device_seconds);
