// SPDX-License-Identifier: MIT
#include "bench_bake_peers.h"

#if KELP_HAVE_ITK

#include <chrono>

#include <itkImage.h>
#include <itkImportImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

namespace kelp::bench {

bool haveItk() { return true; }

EdtRun runItk(const fields::Occupancy& volume, int threads) {
  using Bytes = itk::Image<unsigned char, 3>;
  using Floats = itk::Image<float, 3>;
  const auto import = itk::ImportImageFilter<unsigned char, 3>::New();
  Bytes::RegionType region;
  region.SetSize({static_cast<itk::SizeValueType>(volume.size.x),
                  static_cast<itk::SizeValueType>(volume.size.y),
                  static_cast<itk::SizeValueType>(volume.size.z)});
  import->SetRegion(region);
  import->SetImportPointer(const_cast<unsigned char*>(volume.solid.data()), volume.solid.size(), false);
  import->Update();
  const auto filter = itk::SignedMaurerDistanceMapImageFilter<Bytes, Floats>::New();
  filter->SetInput(import->GetOutput());
  filter->SetSquaredDistance(true);
  filter->SetUseImageSpacing(false);
  filter->SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(threads));
  const auto start = std::chrono::steady_clock::now();
  filter->Update();
  EdtRun run;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const float* const values = filter->GetOutput()->GetBufferPointer();
  run.squared.assign(values, values + volume.solid.size());
  return run;
}

}  // namespace kelp::bench

#else

namespace kelp::bench {
bool haveItk() { return false; }
EdtRun runItk(const fields::Occupancy&, int) { return {}; }
}  // namespace kelp::bench

#endif
