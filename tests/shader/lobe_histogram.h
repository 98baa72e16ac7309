#pragma once

#include <vector>

#include "tests/shader/bsdf_probe_runner.h"

/// χ² of the directions that a BSDF draws against its own pdf.
namespace tilefarm {

/// Where cells are counted: expectations, and what was found instead.
struct Cell {
    double expected = 0, seen = 0;
};

struct ChiSquare {
    double statistic = 0;
    int freedom = 0;  // 0: nothing to tell by chance
    double p = 1;
};

/// Of cells that are a partition; the smallest are put together until each expects 20.
ChiSquare chiSquareOf(std::vector<Cell> cells);

/// 1 − (1 − p)ⁿ of the smallest of n p-values (Šidák 1967): how likely one so small is where all is right.
double sidak(double smallest, size_t count);

/// Draws `samples` directions seen from wo and compares them with the integral of the pdf over cells of the
/// sphere. Cells are in slopes of the half vector, at distances that grow like exponentials from α on, which
/// resolves the highlight of any α and what is as wide as the hemisphere alike; directions below the surface
/// to which no half vector leads are in cells of their own, and so is all that is rejected or a delta.
/// `overshoot`: by how much the pdf integrates to more than 1.
ChiSquare lobeHistogram(BsdfProbe& probe, const ProbeMaterial& material, const glm::vec3& wo, int samples,
                        uint32_t seed, double& overshoot);

}  // namespace tilefarm
