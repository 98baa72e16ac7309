-- name: find
SELECT * FROM studies WHERE id = :id;

-- name: list
SELECT * FROM studies WHERE key < :before ORDER BY key DESC LIMIT :limit;

-- name: open
SELECT * FROM studies WHERE finished IS NULL ORDER BY key;

-- name: insert
INSERT INTO studies (id, state, request, created, finished, fault)
VALUES (:id, :state, :request, :created, :finished, :fault);

-- name: update
UPDATE studies SET state = :state, finished = :finished, fault = :fault WHERE key = :key;

-- name: cells
SELECT study, cell, result, '' AS pictures FROM study_cells WHERE study = :study ORDER BY cell;

-- name: cell
SELECT * FROM study_cells WHERE study = :study AND cell = :cell;

-- name: putCell
INSERT OR REPLACE INTO study_cells (study, cell, result, pictures) VALUES (:study, :cell, :result, :pictures);
