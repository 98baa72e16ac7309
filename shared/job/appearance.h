#pragma once

/// MaterialOverride: what a job says of materials beyond their glTF file; what is not given stays as the file
/// has it. Its members are rows of shaders/tables/materials.py, and are what the vendor extension
/// TILEFARM_materials of a glTF material may hold.
#include "job_material.h"
