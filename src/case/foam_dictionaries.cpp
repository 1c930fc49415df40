#include "foam_dictionaries.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "tetropolis/case/wind.h"
#include "tetropolis/core/version.h"

namespace tetropolis {

namespace {

constexpr double kC1 = 1.44, kC2 = 1.92, kSigmaK = 1;

/// Keeps the profile in balance with kappa 0.4: kappa^2 / ((C2 - C1) sqrt(Cmu)).
double sigma_epsilon() { return kKarman * kKarman / ((kC2 - kC1) * std::sqrt(kCmu)); }

/// What is solved is written at the end, and every 50 to 100 iterations where these divide them.
int write_interval(int iterations) {
  for (int parts = (iterations + 99) / 100; iterations / parts >= 50; ++parts)
    if (iterations % parts == 0) return iterations / parts;
  return iterations;
}

}  // namespace

std::string foam_head(const std::string& type, const std::string& object) {
  return fmt::format(
      "{} {}.\nFoamFile\n{{\n    version     2.0;\n    format      ascii;\n"
      "    class       {};\n    object      {};\n}}\n\n",
      kFoamFirstWords, kVersion, type, object);
}

std::string control_dict(const OpenfoamCaseOptions& options, const char* points) {
  const bool is_org = options.dialect == FoamDialect::kOrg;
  return foam_head("dictionary", "controlDict") +
         fmt::format(R"(application     {};
{}startFrom       latestTime;
startTime       0;
stopAt          endTime;
endTime         {};
deltaT          1;
writeControl    timeStep;
writeInterval   {};  // endTime is a multiple of it
purgeWrite      1;
writeFormat     binary;
writePrecision  8;
timePrecision   8;
runTimeModifiable true;
libs            ("libatmosphericModels.so");  // roughness, in later versions

functions
{{
    #include "{}"
}}
)",
                     is_org ? "foamRun" : "simpleFoam",
                     is_org ? "solver          incompressibleFluid;\n" : "", options.iterations,
                     write_interval(options.iterations), points);
}

std::string pedestrian_dict(const OpenfoamCaseOptions& options, const SamplePoints& samples) {
  const bool is_org = options.dialect == FoamDialect::kOrg;
  std::string text = fmt::format(R"(// Written by tetropolis {}: points {} m above the ground.
pedestrian
{{
    type            sets;
    libs            ("libsampling.so");
    writeControl    writeTime;
    interpolationScheme cellPoint;
    setFormat       raw;
    fields          (U);
    sets
    (
        grid
        {{
            type    {};
            axis    xyz;
            ordered yes;
            points
            (
)",
                                 kVersion, options.sample_height, is_org ? "points" : "cloud");
  for (const Point3& p : samples.points)
    fmt::format_to(std::back_inserter(text), "({:.8g} {:.8g} {:.8g})\n", p[0], p[1], p[2]);
  return text + "            );\n        }\n    );\n}\n";
}

std::string turbulence_dict(const std::string& object, bool is_org, bool leaves) {
  const char* const model = leaves ? "kEpsilonLopesdaCosta" : "kEpsilon";
  return foam_head("dictionary", object) +
         fmt::format(
             "simulationType  RAS;\n\nRAS\n{{\n    {}        {};\n    turbulence      on;\n"
             "    printCoeffs     on;\n    {}Coeffs {{ Cmu {}; C1 {}; C2 {}; sigmak {:.1f}; "
             "sigmaEps {:.4f}; }}\n}}\n",
             is_org ? "model   " : "RASModel", model, model, kCmu, kC1, kC2, kSigmaK,
             sigma_epsilon());
}

std::string leaf_drag(const OpenfoamCaseOptions& options, const FoamMesh& mesh,
                      const std::string& object) {
  std::string text = foam_head("dictionary", object);
  for (const FoamCanopy& canopy : mesh.canopies) {
    const double f = 2 * options.leaf_drag * canopy.leaf_area_density;
    text += fmt::format(R"({0}  // 2 Cd LAD: leaf area density {1} 1/m
{{
    type            explicitPorositySource;
    explicitPorositySourceCoeffs
    {{
        selectionMode   cellZone;
        cellZone        {0};
        type            DarcyForchheimer;
        d               (0 0 0);
        f               ({2:.8g} {2:.8g} {2:.8g});
        coordinateSystem
        {{
            type    cartesian;
            origin  (0 0 0);
            coordinateRotation {{ type axesRotation; e1 (1 0 0); e2 (0 1 0); }}
        }}
    }}
}}
)",
                        canopy.name, canopy.leaf_area_density, f);
  }
  return text;
}

std::string marks_name(std::size_t i) { return fmt::format("leaves_{}.obj", i + 1); }

std::string leaf_sources(const OpenfoamCaseOptions& options, const FoamMesh& mesh,
                         const std::vector<LeafMarks>& marks) {
  std::string text, ground;
  for (const FoamPatch& patch : mesh.patches)
    if (patch.is_wall && !patch.of_building()) ground += (ground.empty() ? "" : " ") + patch.name;
  for (std::size_t i = 0; i < marks.size(); ++i)
    text += fmt::format(R"(leaves_{0}  // k and epsilon where the leaf area density is {1} 1/m
{{
    type            explicitPorositySource;
    explicitPorositySourceCoeffs
    {{
        selectionMode   all;
        type            powerLawLopesdaCosta;
        Sigma           constant {1};
        CdSigma         {2};
        betap           1;
        betad           4;
        C4              1.5;
        C5              1.5;
        powerLawLopesdaCostaCoeffs
        {{
            Cd              0;  // drag is above
            C1              2;
            zDir            (0 0 1);
            searchSpan      {3};
            topSurface      {4};
            groundPatches   ({5});
            coordinateSystem
            {{
                type    cartesian;
                origin  (0 0 0);
                coordinateRotation {{ type axesRotation; e1 (1 0 0); e2 (0 1 0); }}
            }}
        }}
    }}
}}
)",
                        i + 1, marks[i].leaf_area_density, options.leaf_drag, 2 * kMarkHeight,
                        marks_name(i), ground);
  return text;
}

}  // namespace tetropolis
