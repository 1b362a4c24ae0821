# A build of relief textures in a Makefile of a few lines.
# SPDX-License-Identifier: MIT
#
#	RELIEF_SRC = textures
#	RELIEF_OUT = build
#	RELIEF_NAMES = bricks stone cloth
#	RELIEF_META = wall
#	wall_LAYERS = stone -w 0.3 -t 4 cloth
#	include $(shell pkg-config --variable=mk relief)
#
# Then 'make' bakes all of it, or what is out of date of it, 'make relief' too
# where the Makefile has targets of its own, and 'make clean-relief' removes
# it. Out of date is what is missing, what is older than a file that it was
# made from, also one that a material, a glTF file or an @FILE names (the tools
# write what they read, -M), and what was made by another command line. Any -j
# is safe. A build that was ended, in whatever way, goes on where it was. It
# needs GNU make 4.3. Make itself has no names with blanks; nor has this.
#
# Set all variables before the include line, or on make's command line.
#
# What to make, each a list of names (with folders where they have some):
#
#   RELIEF_NAMES        SRC/NAME_depth.*, or NAME_height.*, and NAME_normal.*,
#                       either or both: OUT/NAME_ao.png and OUT/NAME_relief.png.
#                       SRC/NAME_ao.*, if it is there, is taken as it is.
#   RELIEF_META         NAME_LAYERS, the arguments of rm-combine, where a name
#                       of these two lists stands for its texture:
#                       OUT/NAME_relief.png
#   RELIEF_QUADRICS     a mesh, SRC/NAME.obj, .ply, .stl, .glb, .gltf or .fbx:
#                       OUT/NAME_quadric.tsv
#   RELIEF_MULTILAYER   a mesh: OUT/NAME_depth.png, _nx, _ny, _color
#   RELIEF_LUTS         SRC/NAME_color.*: OUT/NAME_lut.png, by rm-roughen
#   RELIEF_PREVIEWS     names of the above that are textures, or of
#                       RELIEF_MULTILAYER: OUT/NAME_preview.png, by rm-render
#   RELIEF_RESCALE      factors of the depth, of all NAMES and META, or
#   NAME_RESCALE        of that one: OUT/NAME_relief_x2.png, by rm-rescale-ao
#
# Where, and of what kind:
#
#   RELIEF_SRC, RELIEF_OUT   folders, by default the one that make runs in
#   RELIEF_EXT               png, tga, tiff or exr: of the outputs, png
#   RELIEF_QUADRIC_EXT       tsv, json, ply, glb or gltf: tsv
#   RELIEF_TARGET, NAME_TARGET      of rm-pack and rm-combine, by default relief
#   RM_DEPTH_SCALE, NAME_DEPTH_SCALE   by default the files', or 0.1
#   NAME_DEPTH, _HEIGHT, _NORMAL, _AO, _COLOR, _MESH   a file of another name;
#                            NAME_AO = none: no occlusion
#   RELIEF_STAMP             any text; when it changes all is made anew, as by
#                            RELIEF_STAMP := $(shell rm-pack --version)
#
# Options, TOOL being AOBAKE, COMBINE, MULTILAYER, PACK, QUADFIT, RENDER,
# RESCALE or ROUGHEN:
#
#   RM_FLAGS, NAME_FLAGS     of rm-pack and rm-aobake: -d, --height, --wrap ...
#   RM_TOOL_FLAGS, NAME_TOOL_FLAGS     of that tool; those of a name come last.
#                            A file of OUT that is named here is made first.
#   NAME_TOOL_OUTPUTS        further files that such options write
#   RM_TOOL                  the program itself: RM_PACK = /opt/rm-pack
#   RM_QUIET                 -q; empty for warnings and progress
#
# How to run:
#
#   RELIEF_LAUNCH            nothing; slurm, each tool a batch job of its own,
#                            which a lost node or 'scontrol requeue' starts
#                            anew; srun, each a job that is not; or what to
#                            write before each command, as 'nice -n 19'
#   RELIEF_SLURM_FLAGS       of sbatch or srun: -p render --time=60
#   RELIEF_CPUS, RM_TOOL_CPUS, NAME_TOOL_CPUS    processors of a job, 1
#   RELIEF_MEM, RM_TOOL_MEM, NAME_TOOL_MEM       its memory, as --mem has it
#   RELIEF_THREADS           threads of each tool; by default its processors
#                            in a job, 1 with make -j, else all there are
#   V=1                      show the commands
#
# Without any of the lists there are pattern rules instead, for files beside
# their inputs: NAME_relief.png from NAME_depth.png, NAME_normal.png or both,
# NAME_ao.png from NAME_depth.png.

RM_AOBAKE ?= rm-aobake
RM_COMBINE ?= rm-combine
RM_MULTILAYER ?= rm-multilayer
RM_PACK ?= rm-pack
RM_QUADFIT ?= rm-quadfit
RM_RENDER ?= rm-render
RM_RESCALE ?= rm-rescale-ao
RM_ROUGHEN ?= rm-roughen
RM_QUIET ?= -q
RELIEF_SRC ?= .
RELIEF_OUT ?= .
RELIEF_EXT ?= png
RELIEF_QUADRIC_EXT ?= tsv
RELIEF_TARGET ?= relief
RELIEF_CPUS ?= 1

ifneq ($(strip $(RELIEF_NAMES) $(RELIEF_META) $(RELIEF_QUADRICS) \
	$(RELIEF_MULTILAYER) $(RELIEF_LUTS)),)

ifeq ($(filter grouped-target,$(.FEATURES)),)
$(error relief.mk needs GNU make 4.3 or later, this is $(MAKE_VERSION))
endif

# the default goal, unless there is one
relief:

relief_s := $(patsubst ./%,%,$(RELIEF_SRC:%/=%)/)
relief_o := $(patsubst ./%,%,$(RELIEF_OUT:%/=%)/)
relief_steps :=
define relief_nl


endef
relief_empty :=
relief_space := $(relief_empty) $(relief_empty)
relief_equal = $(and $(findstring $1,$2),$(findstring $2,$1))
relief_quote = $(subst ','\'',$1)

# -- files -----------------------------------------------------------------
relief_images := png tga tif tiff exr jpg jpeg hdr
relief_meshes := obj ply stl glb gltf fbx
# $(call relief_find,NAME_depth,SUFFIXES): the file in SRC, if there is one
relief_find = $(firstword $(wildcard $(foreach e,$2,$(relief_s)$1.$e)))
# ... else its most likely name, so that make's error tells what is missing
relief_need = $(or $($1_$2),$(call relief_find,$3,$4),$(relief_s)$3.$(firstword $4))
relief_map = $(or $($1_$2),$(call relief_find,$1_$3,$(relief_images)))
# What make itself wrote is no occlusion map of the user's, where SRC is OUT.
relief_ready_ao = $(or $($1_AO),$(foreach f,$(call relief_find,$1_ao,$(relief_images)),$(if $(and $(call relief_equal,$f,$(relief_o)$1_ao.$(RELIEF_EXT)),$(wildcard $(call relief_state,$f).cmd)),,$f)))
relief_state = $(dir $1).relief/$(notdir $1)
relief_out = $(relief_o)$1.$(RELIEF_EXT)

# -- steps -----------------------------------------------------------------
# Each step is one run of a tool, known by its first output.
# $(call relief_step,FIRST,FURTHER,TOOL,NAME,INPUTS,ARGUMENTS,RM_FLAGS?)
define relief_step
$(foreach f,$1 $2 $($4_$3_OUTPUTS),$(if $(relief_made.$f),$(error relief.mk: \
'$f' would be made for '$4' and for '$(relief_made.$f)')))
$(foreach f,$1 $2 $($4_$3_OUTPUTS),$(eval relief_made.$f := $4))
$(eval relief_steps += $1)
$(eval relief_outs.$1 := $1 $2 $($4_$3_OUTPUTS))
$(eval relief_tool.$1 := $3)
$(eval relief_name.$1 := $4)
$(eval relief_in.$1 := $5)
$(eval relief_args.$1 = $$(if $7,$$(RM_FLAGS) $$($4_FLAGS)) $$(RM_$3_FLAGS) \
	$$($4_$3_FLAGS) $6)
endef

# What rm-pack writes beside the first file, and which of them holds AO.
relief_more.unity-hdrp := _height _mask
relief_more.unreal := _height _orm
relief_more.godot := _height _orm
relief_more.babylon := _ao
relief_more.bevy := _depth _ao
relief_more.three := _height _ao
relief_more.gltf := _orm _depth
relief_ao.unity-hdrp := _mask
relief_ao.unreal := _orm
relief_ao.godot := _orm
relief_ao.gltf := _orm
relief_ao.babylon := _ao
relief_ao.bevy := _ao
relief_ao.three := _ao
relief_no_ao := quake3 darkplaces

relief_target = $(or $($1_TARGET),$(RELIEF_TARGET))
relief_target_option = $(if $(filter relief,$(relief_target)),,--target $(relief_target))
relief_packed_more = $(foreach m,$(relief_more.$(relief_target)),$(call relief_out,$1_relief$m))
relief_scale = $(addprefix -s ,$(or $($1_DEPTH_SCALE),$(RM_DEPTH_SCALE)))
relief_check_layer = $(if $(filter relief policarpo,$(relief_target)),,$(error \
	relief.mk: '$1' is read as a packed texture, so $1_TARGET must be relief))

# $(call relief_texture,NAME,DEPTH,HEIGHT,NORMAL,AO)
define relief_texture
$(if $(or $2,$3),$(if $5,,$(call relief_step,$(call relief_out,$1_ao),,AOBAKE,$1,$(or $2,$3),$(if $2,,--height) $(relief_scale) $(or $2,$3) -o $(call relief_out,$1_ao),y)))
$(eval relief_ao_of := $(or $5,$(if $(or $2,$3),$(call relief_out,$1_ao))))
$(call relief_step,$(call relief_out,$1_relief),$(relief_packed_more),PACK,$1,$2 $3 $4 $(filter-out none,$(relief_ao_of)),$(relief_target_option) $(if $(or $2,$3),$(relief_scale),$(addprefix -s ,$($1_DEPTH_SCALE))) $(if $4,--normal $4) $(if $2,--depth $2,$(if $3,--height --depth $3)) $(if $(relief_ao_of),--ao $(relief_ao_of)) -o $(call relief_out,$1_relief),y)
endef
# A depth map wins over a height map; without any map the depth is missing.
define relief_texture_of
$(eval relief_d := $(call relief_map,$1,DEPTH,depth))
$(eval relief_h := $(if $(relief_d),,$(call relief_map,$1,HEIGHT,height)))
$(eval relief_n := $(call relief_map,$1,NORMAL,normal))
$(if $(relief_d)$(relief_h)$(relief_n),,$(eval relief_d := $(relief_s)$1_depth.png))
$(call relief_texture,$1,$(relief_d),$(relief_h),$(relief_n),$(relief_ready_ao))
endef

relief_layer = $(if $(filter $1,$(RELIEF_NAMES) $(RELIEF_META)),$(relief_check_layer)$(call relief_out,$1_relief),$1)
relief_meta = $(call relief_step,$(call relief_out,$1_relief),$(relief_packed_more),COMBINE,$1,,$(relief_target_option) $(addprefix -s ,$($1_DEPTH_SCALE)) $(foreach w,$($1_LAYERS),$(call relief_layer,$w)) -o $(call relief_out,$1_relief))

# $(call relief_rescaled,NAME,FACTOR)
relief_ao_file = $(if $(filter $(relief_no_ao),$(relief_target)),$(error \
	relief.mk: '$1' cannot be rescaled, target $(relief_target) has no AO))$1_relief$(relief_ao.$(relief_target))
relief_rescaled = $(call relief_step,$(call relief_out,$(relief_ao_file)_x$2),,RESCALE,$1,$(call relief_out,$(relief_ao_file)),--scale $2 $(call relief_out,$(relief_ao_file)) -o $(call relief_out,$(relief_ao_file)_x$2))

relief_mesh = $(call relief_need,$1,MESH,$1,$(relief_meshes))
relief_quadric = $(call relief_step,$(relief_o)$1_quadric.$(RELIEF_QUADRIC_EXT),,QUADFIT,$1,$(relief_mesh),$(relief_mesh) -o $(relief_o)$1_quadric.$(RELIEF_QUADRIC_EXT))

# Options decide what is written. The first run's guess is this, from then on
# the tool's own list of what it wrote holds.
relief_ml_flags = $(RM_MULTILAYER_FLAGS) $($1_MULTILAYER_FLAGS)
relief_ml_views = $(if $(filter --views --views=3,$(relief_ml_flags)),_x _y _z,relief_none)
relief_ml_maps = $(if $(filter --deep --multi-part,$(relief_ml_flags)),.exr,$(patsubst %,_%.$(RELIEF_EXT),depth nx ny $(if $(filter --no-color,$(relief_ml_flags)),,color)))
relief_ml_files = $(foreach v,$(relief_ml_views),$(addprefix $(relief_o)$1$(v:relief_none=),$(relief_ml_maps)))
relief_multilayer = $(call relief_step,$(firstword $(relief_ml_files)),$(wordlist 2,99,$(relief_ml_files)),MULTILAYER,$1,$(relief_mesh),$(if $(filter --deep --multi-part,$(relief_ml_flags)),-o $(relief_o)$1.exr,--format $(RELIEF_EXT) -o $(relief_o)$1) $(relief_mesh))

relief_color = $(call relief_need,$1,COLOR,$1_color,$(relief_images))
relief_lut = $(call relief_step,$(call relief_out,$1_lut),,ROUGHEN,$1,$(relief_color),$(relief_color) --lut $(call relief_out,$1_lut))

relief_solid = $(if $(filter --deep --multi-part,$(relief_ml_flags)),$(relief_o)$1.exr,$(relief_o)$1$(filter-out relief_none,$(firstword $(relief_ml_views))))
relief_preview = $(call relief_step,$(call relief_out,$1_preview),,RENDER,$1,$(if $(filter $1,$(RELIEF_MULTILAYER)),$(relief_ml_files),$(relief_check_layer)$(call relief_out,$1_relief)),$(if $(filter $1,$(RELIEF_MULTILAYER)),--multilayer $(relief_solid),$(call relief_out,$1_relief)) -o $(call relief_out,$1_preview))

relief_lists := $(foreach n,$(sort $(RELIEF_NAMES)),$(call relief_texture_of,$n)) \
	$(foreach n,$(sort $(RELIEF_META)),$(call relief_meta,$n)) \
	$(foreach n,$(sort $(RELIEF_NAMES) $(RELIEF_META)),\
	    $(foreach f,$(sort $(RELIEF_RESCALE) $($n_RESCALE)),$(call relief_rescaled,$n,$f))) \
	$(foreach n,$(sort $(RELIEF_QUADRICS)),$(call relief_quadric,$n)) \
	$(foreach n,$(sort $(RELIEF_MULTILAYER)),$(call relief_multilayer,$n)) \
	$(foreach n,$(sort $(RELIEF_LUTS)),$(call relief_lut,$n)) \
	$(foreach n,$(sort $(RELIEF_PREVIEWS)),$(call relief_preview,$n))

# -- running ---------------------------------------------------------------
# $1 is the step in all of these.
relief_own = $(or $($(relief_name.$1)_$(relief_tool.$1)_$2),$(RM_$(relief_tool.$1)_$2),$(RELIEF_$2))
relief_in_job := $(filter slurm srun,$(RELIEF_LAUNCH))
relief_threads = $(or $(RELIEF_THREADS),$(if $(relief_in_job),$(call relief_own,$1,CPUS)),$(if $(findstring jobserver,$(MAKEFLAGS)),1))
relief_command = $(RM_$(relief_tool.$1)) $(RM_QUIET) $(addprefix -j ,$(relief_threads)) -M $(relief_state).d $(relief_args.$1)
relief_job = -n 1 -c $(call relief_own,$1,CPUS) $(addprefix --mem=,$(call relief_own,$1,MEM)) -J 'relief:$(abspath $1)' $(RELIEF_SLURM_FLAGS)

# srun's jobs cannot be requeued, batch jobs can; 'sbatch --wait' looks after
# 2, 10, 42 seconds and so on. So the job leaves its exit status in a file, and
# Slurm is asked only every now and then. A tool that was killed leaves none,
# as it may be about to run again. 'singleton' waits for an older job that the
# killing of an older make left behind.
define relief_slurm
rm -f $(relief_state).status.*; \
id=$$(sbatch --parsable --requeue -d singleton $(relief_job) \
    -o $(relief_state).log --wrap '$(call relief_quote,$(relief_command)); \
    s=$$?; [ $$s -gt 128 ] || \
    echo $$s >$(relief_state).status.$$SLURM_JOB_ID; exit $$s') || exit 1; \
id=$${id%%;*}; f=$(relief_state).status.$$id; s= n=0 gone=0; \
trap 'scancel -Q $$id; exit 130' HUP INT TERM; \
until [ -n "$$s" ]; do \
	sleep $$((n < 60 ? 1 : 3)); n=$$((n + 1)); \
	if [ -s $$f ]; then s=$$(cat $$f); \
	elif [ $$((n % 10)) -eq 0 ]; then \
		state=$$(squeue -h -t all -j $$id -o %T 2>&1); \
		case $$state in \
		COMPLETED) s=0 ;; \
		BOOT_FAIL | CANCELLED | DEADLINE | FAILED | NODE_FAIL | \
		OUT_OF_MEMORY | PREEMPTED | TIMEOUT | *Invalid\ job*) \
			gone=$$((gone + 1)) ;; \
		*) gone=0 ;; \
		esac; \
		[ $$gone -lt 2 ] || { s=1; echo "job $$id: $$state" >&2; }; \
	fi; \
done; \
trap - HUP INT TERM; \
cat $(relief_state).log >&2; rm -f $$f $(relief_state).log; [ $$s -eq 0 ]
endef
relief_launch.slurm = { $(relief_slurm); }
relief_launch.srun = srun --quiet $(relief_job) $(relief_command)
relief_launched = $(or $(relief_launch.$(strip $(RELIEF_LAUNCH))),$(RELIEF_LAUNCH) $(relief_command))
# The command is recorded last, and none while it runs: what was ended between
# its outputs and its depfile, or half-way to another command, is made anew.
relief_run = $(if $(V),,@echo '  $1'; ): >$(relief_state).cmd && \
$(relief_launched) && \
printf '%s\n' '$(call relief_quote,$(relief_stamp.$1))' >$(relief_state).cmd

# -- rules -----------------------------------------------------------------
# What a depfile says was written: the words before its first colon.
relief_first_line = $(subst :?\, ,$(firstword $(subst $(relief_space),?,$1)))
relief_written = $(subst ?, ,$(call relief_first_line,$(relief_dep.$1)))
# Files in the command that are made here: a word, or behind an equals sign.
relief_words = $(subst =, ,$(relief_args.$1))
relief_uses = $(filter-out $(relief_outs.$1),$(foreach w,$(relief_words),$(if $(relief_made.$w),$w)))

# Depfiles are read, not included: make would stop at a broken one. Make 4.3
# does not always drop the newline at the end of a file: strip.
define relief_read
relief_dep.$1 := $$(file <$(relief_state).d)
relief_stamp.$1 := $$(strip $$(RM_$(relief_tool.$1)) $$(relief_args.$1) $$(RELIEF_STAMP))
relief_new.$1 := $$(if $$(relief_dep.$1),$$(if $$(call relief_equal,$$(relief_stamp.$1),$$(strip $$(file <$(relief_state).cmd))),,y),y)
relief_group.$1 := $$(or $$(call relief_written,$1),$$(relief_outs.$1))
endef
define relief_rule
$(relief_group.$1) $(if $(word 2,$(relief_group.$1)),&): $(relief_in.$1) $(relief_uses) $(if $(relief_new.$1),relief-force) | $(patsubst %/,%,$(dir $(relief_state)))
	$$(call relief_run,$1)
$(relief_dep.$1)
relief: $(relief_group.$1)
endef
$(foreach s,$(relief_steps),$(eval $(call relief_read,$s)))
$(foreach s,$(relief_steps),$(eval $(call relief_rule,$s)))

relief_dirs := $(sort $(foreach s,$(relief_steps),$(patsubst %/,%,$(dir $(call relief_state,$s)))))
$(relief_dirs):
	@mkdir -p $@

relief_files := $(foreach s,$(relief_steps),$(relief_group.$s) $(relief_outs.$s) $(addprefix $(call relief_state,$s),.d .cmd .log .status.*))
# no more than a command line holds
relief_rm = $(if $1,@rm -f $(wordlist 1,200,$1)$(relief_nl)$(call relief_rm,$(wordlist 201,$(words $1),$1)))
clean-relief:
	$(call relief_rm,$(relief_files))
	@rmdir $(relief_dirs) $(sort $(relief_dirs:/.relief=)) 2>/dev/null || :

# what a signal interrupts is old or new, and whole
.PRECIOUS: $(relief_files)
.PHONY: relief clean-relief relief-force

else

%_relief.png: %_depth.png %_normal.png
	$(RM_PACK) $(RM_QUIET) $(addprefix -s ,$(RM_DEPTH_SCALE)) $(RM_FLAGS) \
	    $(RM_PACK_FLAGS) -M $(@D)/.$(@F).d \
	    --normal $*_normal.png --depth $*_depth.png -o $@
%_relief.png: %_depth.png
	$(RM_PACK) $(RM_QUIET) $(addprefix -s ,$(RM_DEPTH_SCALE)) $(RM_FLAGS) \
	    $(RM_PACK_FLAGS) -M $(@D)/.$(@F).d --depth $*_depth.png -o $@
%_relief.png: %_normal.png
	$(RM_PACK) $(RM_QUIET) $(RM_FLAGS) $(RM_PACK_FLAGS) \
	    -M $(@D)/.$(@F).d --normal $*_normal.png -o $@
%_ao.png: %_depth.png
	$(RM_AOBAKE) $(RM_QUIET) $(addprefix -s ,$(RM_DEPTH_SCALE)) $(RM_FLAGS) \
	    $(RM_AOBAKE_FLAGS) -M $(@D)/.$(@F).d $< -o $@

-include $(wildcard .*_relief.png.d .*_ao.png.d)

endif
