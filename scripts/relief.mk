# Pattern rules that bake relief textures, for GNU make.
# SPDX-License-Identifier: MIT
#
#	include /usr/local/share/relief/relief.mk
#	all: bricks_relief.png bricks_ao.png
#
# NAME_depth.png and, if it is there, NAME_normal.png become
# NAME_relief.png (packed) and NAME_ao.png. A bake is redone when a file that
# it read is newer: the tools write that into .NAME.d themselves.

RM_PACK ?= rm-pack
RM_AOBAKE ?= rm-aobake
RM_DEPTH_SCALE ?= 0.1
# further options, for all: --height, --normal-y down, --wrap clamp ...
RM_FLAGS ?=

%_relief.png: %_depth.png %_normal.png
	$(RM_PACK) -q -s $(RM_DEPTH_SCALE) $(RM_FLAGS) -M $(@D)/.$(@F).d \
	    --normal $*_normal.png --depth $*_depth.png -o $@
%_relief.png: %_depth.png
	$(RM_PACK) -q -s $(RM_DEPTH_SCALE) $(RM_FLAGS) -M $(@D)/.$(@F).d \
	    --depth $*_depth.png -o $@
%_relief.png: %_normal.png
	$(RM_PACK) -q $(RM_FLAGS) -M $(@D)/.$(@F).d \
	    --normal $*_normal.png -o $@
%_ao.png: %_depth.png
	$(RM_AOBAKE) -q -s $(RM_DEPTH_SCALE) $(RM_FLAGS) -M $(@D)/.$(@F).d \
	    $< -o $@

-include $(wildcard .*_relief.png.d .*_ao.png.d)
