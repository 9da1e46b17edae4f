# Cairn's simulation on Debian 12, ready to run: its own worlds, or videos and data sets that are mounted.
#   docker build -t cairn .
#   docker run --rm -v "$PWD:/data" cairn run video:desk.mp4 --hfov 65 --out out/desk
FROM debian:12 AS build
WORKDIR /cairn
COPY scripts/setup.sh scripts/
RUN scripts/setup.sh --demo && rm -rf /var/lib/apt/lists/*
COPY . .
RUN cmake --preset host -DCAIRN_UNITY_BUILD=ON -DCAIRN_BUILD_TESTS=OFF -DCAIRN_BUILD_EXAMPLES=OFF \
    && cmake --build --preset host --target cairn_sim

FROM debian:12
RUN apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
      python3 libopencv-calib3d406 libopencv-contrib406 libopencv-core406 libopencv-features2d406 libopencv-highgui406 \
      libopencv-imgcodecs406 libopencv-imgproc406 libopencv-video406 libopencv-videoio406 libfmt9 libyaml-cpp0.7 \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /cairn/build/host/bin/cairn_sim /cairn/build/host/bin/cairn_count_frames /cairn/build/host/bin/cairn_view \
  /usr/local/bin/
WORKDIR /data
ENTRYPOINT ["cairn_sim"]
CMD ["help"]
