#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/shader/bsdf_probe_runner.h"
#include "tests/shader/device_fixture.h"
#include "tests/shader/lobe_histogram.h"

namespace tilefarm {

/// A material to check. A lobe that others are to trust is a row in its family's table.
struct LobeRow {
    std::string name;
    ProbeMaterial material;
    uint64_t features = 0;
};

/// A direction above the surface; cosTheta ≥ 0.
glm::vec3 directionAt(double cosTheta, double phi = 0.3);

/// Checks that hold for every BSDF whatever its parameters, through the shaders' own code. A failure
/// names the row.
class LobeTest : public DeviceTest {
protected:
    struct Moments {
        glm::dvec3 mean{0};
        double sigma = 0;           // of the mean of red
        glm::dvec3 transmitted{0};  // part of the mean that went below the surface
        /// What of the light the surface keeps in play: radiance is compressed by 1/eta² where it refracts.
        glm::dvec3 energy{0};
        double energySigma = 0;
    };

    BsdfProbe& probe(uint64_t features);

    /// Mean weight of samples: the directional albedo. Random numbers are stratified in u.yz.
    Moments albedo(const LobeRow& row, double cosTheta, int n = 16384, double phi = 0.3);

    /// No more light leaves than comes: energy ≤ 1 at grazing to normal incidence (and ≥ `least`).
    void expectEnergy(const LobeRow& row, double most = 1.005, double least = 0);

    /// Samples carry the weight and pdf that evaluation gives, to 1e-4.
    void expectAgreement(const LobeRow& row);

    /// f(wo, wi) = f(wi, wo), across a refracting interface times eta², to 1e-4.
    void expectReciprocity(const LobeRow& row);

    /// χ² of sampled directions against the pdf (lobe_histogram.h). At the end of the test the smallest p of
    /// all its histograms has to be above 0.01 with Šidák's correction for their number.
    void expectChiSquare(const LobeRow& row, double cosTheta, double phi = 0.4);

    /// Takes in another comparison by chance, of that name.
    void compare(const ChiSquare& found, const std::string& name);

    /// Grazing directions and extreme random numbers give finite answers and pdfs ≥ 0.
    void expectFinite(const LobeRow& row);

    /// All of the above but χ².
    void expectSoundLobe(const LobeRow& row, bool reciprocal = true);

    void TearDown() override;

    /// Histograms of all tests that are parts of one case; 0: those of this test.
    size_t familySize = 0;

private:
    std::vector<std::pair<double, std::string>> comparisons_;  // p-values and what they are of
    std::map<uint64_t, std::unique_ptr<BsdfProbe>> probes_;
};

}  // namespace tilefarm
