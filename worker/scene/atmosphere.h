#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace tilefarm {

/// A clear atmosphere over a round Earth: Rayleigh scattering, aerosol, ozone; all in fp64, lengths in km, colours as
/// the wavelengths 680, 550 and 440 nm that stand for red, green and blue (Bruneton, Neyret 2008).
///
/// Coefficients: Rayleigh and ozone of Hillaire 2020, A Scalable and Production Ready Sky and Atmosphere Rendering
/// Technique, table 1. Aerosol: exponential with a scale height of 1.2 km, single-scattering albedo 0.9 (Bruneton,
/// Neyret 2008), Ångström exponent 1.3, phase function of Cornette and Shanks 1992 with g = 0.8. Turbidity T is the
/// optical thickness of air and aerosol over that of air alone at 550 nm (Preetham et al. 1999): 1 is pure air, 2 an
/// aerosol optical depth of 0.11. Single scattering is marched; all further orders are Hillaire's isotropic series.
class Atmosphere {
public:
    Atmosphere(double turbidity, double groundAlbedo);

    /// What is left of the sun's light `altitude` km above the sea, the sun's zenith distance having this cosine; 0
    /// where the Earth is in the way.
    glm::dvec3 transmittance(double altitude, double cosZenith) const;

    /// Radiance of the sky towards `direction` (not below the horizon; y up) for a sun of irradiance 1 W/m² outside
    /// the atmosphere.
    glm::dvec3 radiance(double altitude, const glm::dvec3& direction, const glm::dvec3& toSun) const;

private:
    struct Medium {
        glm::dvec3 rayleigh, aerosol, extinction;  // scattering and all losses, 1/km
        glm::dvec3 scattering() const { return rayleigh + aerosol; }
    };
    Medium mediumAt(double altitude) const;
    glm::dvec3 opticalTransmittance(double radius, double cosZenith) const;
    void tabulateTransmittance();
    void tabulateMultipleScattering(double groundAlbedo);
    glm::dvec3 multipleScattering(double altitude, double cosSun) const;
    glm::dvec3 multipleScatteringOf(double altitude, double cosSun, double groundAlbedo) const;

    glm::dvec3 aerosolScattering_, aerosolExtinction_;  // at the sea, 1/km
    std::vector<glm::dvec3> transmittance_, multiple_;
};

}  // namespace tilefarm
